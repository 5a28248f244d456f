// Step 4 of the hand-over: the particles' integrals against the mesh's own, which are taken by another route (closed
// forms and a 3 x 3 rule over the elements, not the sampling points).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/particles.hpp"
#include "common/snapshot.hpp"

namespace tailrun::transfer {

struct AuditRow {
  std::string quantity, unit;
  double mesh = 0.0, particles = 0.0;
  double scale = 1.0;      // what the difference is compared with
  bool conserved = false;  // must agree to round-off
  double error() const;    // |particles - mesh|/scale
};

struct Audit {
  std::vector<AuditRow> rows;
  std::vector<std::string> materials;  // with counts, masses, strengths below
  std::vector<long> count;
  std::vector<double> mass, mean_strength;
  double excluded_mass = 0.0;  // kg, of elements that did not become particles
};

// `velocity_offset` is what was taken off the mesh's velocities (the base's). Elements' integrals over kept elements:
//   mass, volume, centre of mass, linear momentum: must agree to 1e-12 (volume only where no element is inverted)
//   kinetic energy, sum of stress x volume, of pore pressure x volume: reported with their change
Audit audit(const Snapshot& snapshot, const std::vector<bool>& kept, std::array<double, 2> velocity_offset,
            const ParticleSet& particles);

// Throws ComputationError naming the first conserved quantity whose error is above `tolerance`.
void require_conserved(const Audit& result, double tolerance = 1e-10);

std::string audit_table(const Audit& result);
nlohmann::ordered_json audit_json(const Audit& result);

}  // namespace tailrun::transfer

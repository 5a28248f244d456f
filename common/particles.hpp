// The particles file: what transfer_tool writes, mpm_stage reads, and mpm_stage writes again as its frames. A valid
// static VTKHDF v1 UnstructuredGrid of vertices; docs/formats.md describes it field by field.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/ponded_water.hpp"
#include "common/provenance.hpp"

namespace tailrun {

constexpr int particles_format_version = 1;

// A bed or wall carried along with the particles, e.g. the top of a foundation that is not turned into particles.
// 2-D: a polyline whose left-hand side (walking from first to last point) is the side where material may be.
struct TerrainLine {
  std::string name;
  std::vector<double> points;  // m, (n, 2) row-major
};

// Structure of arrays over `count` particles; (n, k) arrays are row-major. `components` is 4 in plane strain
// (xx, yy, zz, xy) and 6 in 3-D (xx, yy, zz, xy, yz, zx). Optional arrays are empty when absent.
struct ParticleSet {
  int dimension = 2;
  double time = 0.0;                        // s, since the start of the motion
  double transfer_time = 0.0;               // s
  double particle_size = 0.0;               // m, a typical spacing (square root of the mean volume per unit thickness)
  std::vector<std::string> material_names;  // material_id indexes this
  std::vector<std::string> region_names;    // region_id indexes this
  std::vector<TerrainLine> terrain;
  std::vector<PondedReach> ponds;

  std::vector<double> position;          // m, (n, 3)
  std::vector<double> velocity;          // m/s, (n, 3), relative to the base
  std::vector<double> mass;              // kg (per metre of thickness in plane strain)
  std::vector<double> volume;            // m3 (m2 per metre of thickness)
  std::vector<double> effective_stress;  // Pa, (n, components), tension positive
  std::vector<double> pore_pressure;     // Pa, total, compression positive
  std::vector<std::int32_t> material_id;
  std::vector<std::int32_t> region_id;
  std::vector<std::int64_t> source_element;               // element of the snapshot, -1 when none
  std::vector<double> initial_vertical_effective_stress;  // Pa, compression positive, before shaking
  std::vector<double> depth;                              // m below the initial ground surface
  std::vector<double> excess_pore_pressure_ratio;         // r_u at transfer
  std::vector<double> residual_strength;                  // Pa, s_R where assigned, 0 elsewhere
  std::vector<std::int32_t> strength_law;                 // index into strength_laws, -1 for none
  std::vector<std::string> strength_laws;                 // JSON: the laws that gave residual_strength, with all inputs
  std::vector<double> plastic_deviatoric_strain;          // 1
  std::vector<double> displacement;                       // m, (n, 3), since the start of the motion
  std::map<std::string, std::vector<double>> extra;       // further scalars by name, written as "1" unless in units
  std::map<std::string, std::string> extra_unit;
  std::map<std::string, std::string> notes;  // texts by name, e.g. the hand-over audit as JSON

  std::size_t count() const { return mass.size(); }
  int components() const { return dimension == 2 ? 4 : 6; }
};

enum class Precision { single, full };

// Throws ComputationError when it cannot be written, std::logic_error when array lengths disagree. In single precision
// the fields of the particles take half the bytes; positions and all else stay double.
void write_particles(const std::filesystem::path& path, const ParticleSet& particles, const Provenance& provenance,
                     Precision fields = Precision::full);

// Throws InputError: missing or truncated file, other format or version, a dataset missing or of the wrong shape,
// values that are not finite, masses or volumes that are not positive.
ParticleSet read_particles(const std::filesystem::path& path);

}  // namespace tailrun

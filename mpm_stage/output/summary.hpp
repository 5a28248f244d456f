// summary.json: what the run did, what it cost, and what it found.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "mpm_stage/output/front.hpp"
#include "mpm_stage/output/ledger.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

// Counts kept by the run loop.
struct RunRecord {
  long steps = 0;
  double particle_steps = 0.0;
  double asleep_particle_steps = 0.0;   // of them, in blocks that slept
  double time = 0.0;                    // s, simulated
  double dt_min = 1e300, dt_max = 0.0;  // s
  double wall_seconds = 0.0, output_seconds = 0.0, setup_seconds = 0.0;
  double first_unbalanced = 0.0;  // 1, root sum of squares of nodal out-of-balance forces over that of the weights
  double largest_kinetic = 0.0;   // J
  std::string stop_reason;
  std::size_t frames = 0;
};

template <int Dim>
nlohmann::ordered_json make_summary(const Scene& scene, Solver<Dim>& solver, const RunRecord& record,
                                    const Ledger<Dim>& ledger, const FrontSeries<Dim>& front);

}  // namespace tailrun::mpm

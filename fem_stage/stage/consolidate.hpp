// What follows the shaking: excess pore pressure drains and redistributes while the dam settles or, where water that
// moves up softens the soil, fails late. Quasi-static: backward Euler steps of growing length, each from rest
// (velocity and acceleration zero; M du / dt^2 is left as a regularisation that vanishes with long steps), with the
// moduli that PM4Sand has for reconsolidation (Boulanger & Ziotopoulou 2017, section 2.13).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fem_stage/model/model.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

struct ConsolidationReport {
  double start_time = 0.0, end_time = 0.0, wall_seconds = 0.0;  // s
  double first_ratio = 0.0, last_ratio = 0.0;                   // largest r_u at the start and at the end
  double settlement = 0.0;                                      // m, largest displacement of the consolidation
  double start_velocity = 0.0;  // m/s, largest of the given state, which is taken as zero
  SolverCounts counts;
  std::vector<std::string> snapshots;  // file names
  std::vector<double> snapshot_times;  // s
  std::string failure;                 // empty when the end was reached
};

// Boundaries of the geostatic stage, at the place where the shaking left them; loads of the shaking. Writes
// snapshot_t*.h5, history.csv, quality.csv and consolidated.h5 into `folder`; times go on from the state's. On failure
// the last good state is written as last_good_t*.h5.
ConsolidationReport run_consolidation(const Model& model, MaterialPoints& points, State& state,
                                      const std::filesystem::path& folder);

}  // namespace tailrun::fem

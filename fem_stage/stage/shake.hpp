// The shaking stage: from the geostatic state through the motion, with snapshots, histories and a summary.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/motion.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/output/history.hpp"
#include "fem_stage/solver/energy_ledger.hpp"
#include "fem_stage/solver/newmark.hpp"
#include "fem_stage/stage/transfer_window.hpp"

namespace tailrun::fem {

struct ShakeReport {
  double end_time = 0.0, wall_seconds = 0.0, material_seconds = 0.0, output_seconds = 0.0;
  SolverCounts counts;
  EnergyLedger ledger;
  std::optional<double> energy_open_since, hourglass_since;  // s, when so at the end (energy_watch.hpp)
  std::vector<QualityRow> quality;
  TransferWindow window;
  nlohmann::ordered_json liquefaction;  // liquefaction_summary(); null without residual strengths
  std::vector<std::string> snapshots;   // file names
  std::vector<double> snapshot_times;   // s
  std::string failure;                  // empty when the run reached its end
};

// What may interrupt a shake, and how it goes on.
struct ShakeControl {
  bool resume = false;  // from the folder's checkpoint
  // Called after each step with its number: why the run is to stop, else empty.
  std::function<std::string(long)> interruption;
  std::string resume_command;        // for the message
  double checkpoint_interval = 5.0;  // minutes of wall time
};

// The motion as the case wants it: read, scaled; one without values when the case has none. Throws InputError.
Motion case_motion(const FemCase& options);

// Throws InputError when the snapshots and histories that the case asks for need more room than `folder`'s disk has
// free. `state_bytes`: size of one state file of this model.
void check_shake_output(const FemCase& options, double state_bytes, const std::filesystem::path& folder);

// Writes snapshot_t*.h5, history.csv and quality.csv into `folder`. On failure of the computation the last good state
// is written as last_good_t*.h5 and `failure` says why. Throws InterruptedError, with a checkpoint written, when
// `control` asks for it.
ShakeReport run_shake(const Model& model, MaterialPoints& points, State& state, const Motion& motion,
                      const std::filesystem::path& folder, const ShakeControl& control = {});

}  // namespace tailrun::fem

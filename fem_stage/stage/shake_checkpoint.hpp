// shake_checkpoint.h5: everything that a shake needs to go on bit for bit from a step between its start and its end.
// The file takes its name when it is complete, so the last good one stays until then.
// The Newton matrix, which may be old, is kept by what it was made of, and made again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fem_stage/model/model.hpp"
#include "fem_stage/output/history.hpp"
#include "fem_stage/solver/energy_ledger.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

constexpr int shake_checkpoint_version = 2;
constexpr const char* shake_checkpoint_name = "shake_checkpoint.h5";

// What a shake has to remember besides the model's state.
struct ShakeProgress {
  EnergyLedger ledger;
  SolverCounts counts;
  MatrixMemory matrix;
  std::optional<double> energy_open_since, hourglass_since;  // s (EnergyWatch)
  std::vector<double> hourglass_work;                        // J, (M)
  std::vector<double> last_load;                             // N, (N, 2)
  std::vector<double> free_field;                            // FreeField::memory
  std::vector<QualityRow> quality;
  std::vector<std::string> history_lines, quality_lines;  // rows of the tables so far
  std::vector<std::string> snapshots;                     // file names
  std::vector<double> snapshot_times;                     // s
  double next_record = 0.0, next_regular = 0.0;           // s
  std::size_t next_snapshot = 0;                          // of the list
  double wall_seconds = 0.0, output_seconds = 0.0, material_seconds = 0.0;
};

// Throws ComputationError when the file cannot be written.
void write_shake_checkpoint(const std::filesystem::path& path, const Model& model, const State& state,
                            const MaterialPoints& points, const ShakeProgress& progress);

// Brings `state` and `points` of the same model to where the checkpoint was written. Throws InputError when there is no
// such file, it is damaged, or it belongs to other input (by SHA-256).
ShakeProgress read_shake_checkpoint(const std::filesystem::path& path, const Model& model, State& state,
                                    MaterialPoints& points);

}  // namespace tailrun::fem

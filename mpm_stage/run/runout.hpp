// A run from its scene to its summary: steps, records, frames, checkpoints.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "common/provenance.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

struct RunControl {
  bool resume = false;         // go on from the folder's checkpoint.h5
  std::string resume_command;  // for messages, how to go on
  // Asked after every step, with their number: a reason to stop here and now, empty to go on.
  std::function<std::string(long)> interruption;
};

// Runs `scene` (of dimension Dim) to its end time or to rest and leaves frames/, front.csv, ledger.csv and summary.json
// in `folder`; while it runs, checkpoint.h5 as often as the scene says. Throws InputError when there is nothing to go
// on from, and ComputationError when the computation fails or is interrupted (then a checkpoint has been written).
template <int Dim>
void run_scene(const Scene& scene, const std::filesystem::path& folder, const Provenance& provenance,
               const RunControl& control);

}  // namespace tailrun::mpm

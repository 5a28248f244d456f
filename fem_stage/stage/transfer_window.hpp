// When to hand over to the MPM stage. The window opens when the liquefied depth has levelled off and strong shaking is
// over, and closes when the mesh is too distorted (Sordo, Rathje & Kumar's criteria in words; the numbers are ours).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/motion.hpp"
#include "fem_stage/output/history.hpp"

namespace tailrun::fem {

struct TransferWindow {
  std::optional<double> opens, closes, suggested;  // s; empty when it did not happen in the run
  std::string reason;
};

// `strong_shaking_end` s: 95 % of the motion's Arias intensity.
TransferWindow find_transfer_window(const std::vector<QualityRow>& rows, double strong_shaking_end);

}  // namespace tailrun::fem

// When to hand over to the MPM stage: as early as possible after liquefaction and strong shaking, before the mesh is
// too distorted (Sordo, Rathje & Kumar's criteria in words; the numbers are ours).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/motion.hpp"
#include "fem_stage/output/history.hpp"

namespace tailrun::fem {

struct TransferWindow {
  std::optional<double> opens, closes, suggested;  // s; empty when it did not happen in the run
  double shaking_left = 0.0;                       // 1, share of the Arias intensity that comes after `suggested`
  std::string reason;
};

// Opens when the pore pressure has levelled off (the mean r_u over the liquefaction window, averaged over a second, has
// 95 % of its largest value of the run) and the strong phase is over (75 % of the Arias intensity, the end of the
// significant duration D5-75). Mean r_u and not the liquefied depth, which counts elements above a threshold and moves
// by metres between runs that differ in nothing. 75 % and not 95 %: what shaking is left goes on in the runout when it
// is asked to (base_motion), while what the finite elements slip by grows with the mesh's fineness. Closes when an
// element has lost half of the scaled Jacobian that it began with (a rectangle: sheared by 60 degrees, a strain
// of 1.7); the smallest of the mesh says little, since a corner of the geometry may hold it from the start.
TransferWindow find_transfer_window(const std::vector<QualityRow>& rows, const Motion& motion);

}  // namespace tailrun::fem

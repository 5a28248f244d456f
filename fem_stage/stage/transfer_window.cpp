#include "fem_stage/stage/transfer_window.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace tailrun::fem {
namespace {

constexpr double levelled_off = 0.95;      // of the largest liquefied depth of the run
constexpr double smallest_jacobian = 0.2;  // scaled Jacobian under which an element's strain is no longer trusted
constexpr double lost_quality = 0.5;       // or half of what the worst element had at the start

}  // namespace

TransferWindow find_transfer_window(const std::vector<QualityRow>& rows, double strong_shaking_end) {
  TransferWindow window;
  if (rows.empty()) return window;
  double deepest = 0.0;
  for (const auto& row : rows) deepest = std::max(deepest, row.liquefied_depth);
  if (deepest > 0.0 && rows.back().time >= strong_shaking_end)
    for (const auto& row : rows)
      if (row.liquefied_depth >= levelled_off * deepest) {
        window.opens = std::max(row.time, strong_shaking_end);
        break;
      }
  const double limit = std::min(smallest_jacobian, lost_quality * rows.front().smallest_jacobian);
  for (const auto& row : rows)
    if (row.smallest_jacobian < limit) {
      window.closes = row.time;
      break;
    }
  if (deepest == 0.0) {
    window.reason = "nothing liquefied (or no /output/liquefaction region is given): no reason to hand over";
  } else if (!window.opens) {
    window.reason = fmt::format("the run ends before strong shaking does (95 % of the Arias intensity at {:.1f} s)",
                                strong_shaking_end);
  } else if (window.closes && *window.closes < *window.opens) {
    window.suggested = *window.closes;
    window.reason = fmt::format(
        "the mesh is worn out ({:.1f} s) before the window opens ({:.1f} s): hand over at once, or use a coarser mesh",
        *window.closes, *window.opens);
  } else {
    window.suggested = *window.opens;
    window.reason = fmt::format("liquefied depth levelled off at {:.1f} m and strong shaking over", deepest);
  }
  return window;
}

}  // namespace tailrun::fem

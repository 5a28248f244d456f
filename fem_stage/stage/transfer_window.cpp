#include "fem_stage/stage/transfer_window.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace tailrun::fem {
namespace {

constexpr double strong_phase = 0.75;  // of the Arias intensity
constexpr double levelled_off = 0.95;  // of the largest mean r_u of the run
constexpr double averaged_over = 1.0;  // s: swings of r_u within a cycle of strong shaking are no level
constexpr double least_kept = 0.5;     // of an element's scaled Jacobian: a rectangle sheared by 60 degrees

// 1: mean r_u averaged over the last second, row by row.
std::vector<double> level(const std::vector<QualityRow>& rows) {
  std::vector<double> mean;
  double sum = 0.0;
  std::size_t first = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    sum += rows[k].mean_ratio;
    while (rows[first].time < rows[k].time - averaged_over) sum -= rows[first++].mean_ratio;
    mean.push_back(sum / static_cast<double>(k + 1 - first));
  }
  return mean;
}

}  // namespace

TransferWindow find_transfer_window(const std::vector<QualityRow>& rows, const Motion& motion) {
  TransferWindow window;
  const double strong_until = motion.significant_duration(0.05, strong_phase).second;
  const bool liquefied =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.liquefied_depth > 0.0; });
  const auto worn =
      std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.jacobian_kept < least_kept; });
  if (worn != rows.end()) window.closes = worn->time;
  if (!liquefied) {
    window.reason = "nothing liquefied (or no /output/liquefaction region is given): no reason to hand over";
    return window;
  }
  const std::string strong = fmt::format("75 % of the Arias intensity at {:.1f} s", strong_until);
  if (rows.back().time < strong_until) {
    window.reason = fmt::format("the run ends before strong shaking does ({})", strong);
    return window;
  }
  const std::vector<double> mean = level(rows);
  const double highest = *std::max_element(mean.begin(), mean.end());
  const auto reached = std::find_if(mean.begin(), mean.end(), [&](double x) { return x >= levelled_off * highest; });
  window.opens = std::max(rows[static_cast<std::size_t>(reached - mean.begin())].time, strong_until);
  if (window.closes && *window.closes < *window.opens) {
    window.suggested = *window.closes;
    window.reason = fmt::format(
        "the mesh is worn out ({:.1f} s) before the window opens ({:.1f} s): hand over at once, or use a coarser mesh",
        *window.closes, *window.opens);
  } else {
    window.suggested = *window.opens;
    window.reason = fmt::format("mean r_u has levelled off at {:.2f} and strong shaking is over ({})", highest, strong);
  }
  window.shaking_left = motion.arias_share_after(*window.suggested);
  if (window.shaking_left > 0.05)
    window.reason += fmt::format("; {:.0f} % of the shaking is still to come: base_motion of mpm.json lets it go on",
                                 100.0 * window.shaking_left);
  return window;
}

}  // namespace tailrun::fem

#include "fem_stage/model/idle_loads.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace tailrun::fem {
namespace {

constexpr double nothing = 1e-3;    // of the largest factor
constexpr double most_looks = 1e5;  // along a history

// Largest absolute factor at the steps of the run, or at as many even times as are enough to see one.
double largest_seen(const TimeHistory& history, double duration, double step) {
  const double looks = std::ceil(std::min(duration / step, most_looks));
  double largest = 0.0;
  for (double k = 0.0; k <= looks; k += 1.0) largest = std::max(largest, std::abs(history.at(k / looks * duration)));
  return largest;
}

}  // namespace

void warn_of_idle_loads(const CaseNode& root, const std::vector<LoadOptions>& loads, double duration, double step) {
  const auto nodes = root.list_or_empty("loads");
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const TimeHistory& history = loads[i].history;
    if (history.constant()) continue;
    const double reached = largest_seen(history, duration, step);
    if (reached > nothing * history.largest()) continue;
    nodes[i].warn("history", fmt::format("the load never acts: its factor reaches {:.2g} within the {:g} s of the "
                                         "shaking (/shake/duration)",
                                         reached, duration));
  }
}

}  // namespace tailrun::fem

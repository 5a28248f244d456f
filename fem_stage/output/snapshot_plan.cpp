#include "fem_stage/output/snapshot_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/warnings.hpp"

namespace tailrun::fem {
namespace {

std::string name_with(double time, int decimals) {
  return fmt::format("snapshot_t{:0{}.{}f}.h5", time, 3 + decimals, decimals);
}

std::string first_few(const std::vector<double>& times) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(times.size(), 5); ++i)
    text += fmt::format("{}{:g}", i ? ", " : "", times[i]);
  return text + (times.size() > 5 ? ", ..." : "");
}

}  // namespace

double StepGrid::first_at(double time) const {
  const double slack = 1e-6 * step;
  return std::min(duration, step * std::max(0.0, std::ceil((time - slack) / step)));
}

SnapshotPlan::SnapshotPlan(std::vector<double> times) : times_(std::move(times)) {
  std::sort(times_.begin(), times_.end());
  choose_decimals();
}

SnapshotPlan::SnapshotPlan(const StepGrid& grid, const std::vector<double>& listed, double interval) {
  const double slack = 1e-6 * grid.step;
  std::vector<double> late, between, together;
  for (const double time : listed) {
    if (time > grid.duration + slack) {
      late.push_back(time);
      continue;
    }
    const double at = grid.first_at(time);
    if (at > time + 1e-3 * grid.step) between.push_back(time);
    if (std::find(times_.begin(), times_.end(), at) != times_.end())
      together.push_back(time);
    else
      times_.push_back(at);
  }
  if (!late.empty())
    add_warning(
        fmt::format("/output/snapshots: {} s: after the end of the shaking (/shake/duration, {:g} s): not written",
                    first_few(late), grid.duration));
  if (!between.empty())
    add_warning(fmt::format("/output/snapshots: {} s: between two steps of {:g} s: written at the end of the step",
                            first_few(between), grid.step));
  if (!together.empty())
    add_warning(fmt::format("/output/snapshots: {} s: on the same step of {:g} s as the one before: one file for both",
                            first_few(together), grid.step));
  if (interval > grid.duration + slack)
    add_warning(
        fmt::format("/output/snapshot_interval: {:g} s is longer than the shaking (/shake/duration, {:g} s): none is "
                    "written for it",
                    interval, grid.duration));
  if (interval > 0.0)
    for (double k = 1.0; k * std::max(interval, grid.step) <= grid.duration + slack; ++k)
      times_.push_back(grid.first_at(k * std::max(interval, grid.step)));
  std::sort(times_.begin(), times_.end());
  times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
  choose_decimals();
}

void SnapshotPlan::choose_decimals() {
  for (; decimals_ < 15; ++decimals_) {
    std::set<std::string> names;
    for (const double time : times_) names.insert(name_with(time, decimals_));
    if (names.size() == times_.size()) return;
  }
}

std::string SnapshotPlan::name(double time) const {
  return name_with(time, decimals_);
}

}  // namespace tailrun::fem

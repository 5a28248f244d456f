// Which snapshots a run will write, and their names: the time in seconds with three decimals, and with more where three
// would give two of them one name.
#pragma once

#include <string>
#include <vector>

namespace tailrun::fem {

// Steps of one length from 0 to `duration` (s), the last one cut.
struct StepGrid {
  double duration, step;
  // Time (s) of the first step that is not before `time`; nothing lies after the duration.
  double first_at(double time) const;
};

class SnapshotPlan {
 public:
  SnapshotPlan() = default;
  // At the given times (s), whatever the steps are.
  explicit SnapshotPlan(std::vector<double> times);
  // Of the listed times and regularly, on a grid of steps; `interval` 0: none regularly. Warns of times after the end,
  // between steps, and of two that fall on one step.
  SnapshotPlan(const StepGrid& grid, const std::vector<double>& listed, double interval);

  std::size_t count() const { return times_.size(); }
  // "snapshot_t02.500.h5"
  std::string name(double time) const;

 private:
  void choose_decimals();
  std::vector<double> times_;  // s, ascending
  int decimals_ = 3;
};

}  // namespace tailrun::fem

// The times at which something has to be recorded: multiples of an interval.
#pragma once

namespace tailrun::mpm {

class Schedule {
 public:
  // `interval` s, 0: never. `count` events are over already.
  Schedule(double interval, long count) : interval_(interval), count_(count) {}
  double next() const { return interval_ > 0.0 ? static_cast<double>(count_) * interval_ : 1e300; }
  bool due(double time) const { return time >= next() * (1.0 - 1e-12) - 1e-12; }
  void advance() { ++count_; }
  long count() const { return count_; }

 private:
  double interval_;
  long count_;
};

}  // namespace tailrun::mpm

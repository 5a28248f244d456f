// Progress of a long phase on standard error: a bar with percent, simulated time, steps per second and time left on a
// terminal, one line at its end when standard error is not one, nothing with --quiet.
#pragma once

#include <chrono>
#include <string>

namespace tailrun {

class Progress {
 public:
  // `total` in `unit` (simulated seconds, elements ...).
  Progress(std::string phase, double total, std::string unit);
  ~Progress();
  void update(double done, long steps, const std::string& note = {});  // cheap: draws at most 5 times a second
  void finish(const std::string& note = {});

 private:
  double elapsed() const;
  std::string phase_, unit_;
  double total_, done_ = 0.0;
  long steps_ = 0;
  bool finished_ = false;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace tailrun

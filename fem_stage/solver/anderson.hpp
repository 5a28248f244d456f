// Anderson acceleration (Anderson 1965; Walker & Ni 2011, type II) of the fixed-point iteration x <- x + d(x), where d
// is the correction of a modified Newton iteration with an old matrix. Combines the last few corrections so that the
// combined one is least in the given weights.
#pragma once

#include <span>
#include <vector>

namespace tailrun::fem {

class Anderson {
 public:
  Anderson(std::size_t unknowns, int depth, std::vector<double> weights);
  void restart();
  // `correction` is d(x) at the current x; it is replaced by the accelerated step to add to x.
  void accelerate(std::span<double> correction);

 private:
  std::size_t n_;
  std::size_t depth_;
  std::vector<double> weights_;
  std::vector<double> last_correction_, last_step_;
  std::vector<std::vector<double>> correction_changes_, step_and_changes_;
  std::size_t stored_ = 0, next_ = 0;
  bool first_ = true;
};

}  // namespace tailrun::fem

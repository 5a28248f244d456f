#include "common/residual_strength/strength_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tailrun {

Strength StrengthLaw::operator()(double sigma_v0) const {
  const double sigma = std::max(sigma_v0, 0.0);
  Strength result;
  result.is_outside = sigma < domain.first || sigma > domain.second;
  result.value = factor * evaluate_model(sigma);
  const double cap = sigma * std::tan(friction_angle * std::numbers::pi / 180.0);
  if (drained_cap && result.value > cap) {
    result.value = cap;
    result.is_capped = true;
  }
  const double lowest = std::max(minimum_ratio * sigma, minimum_strength);
  if (result.value < lowest) {
    result.value = lowest;
    result.is_raised = true;
  }
  return result;
}

}  // namespace tailrun

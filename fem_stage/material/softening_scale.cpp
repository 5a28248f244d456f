#include "fem_stage/material/softening_scale.hpp"

namespace tailrun::fem {

std::span<const double> SofteningScale::driving_strain(std::span<const double> strain_increment) {
  driving_.assign(strain_increment.begin(), strain_increment.end());
  for (std::size_t i = 0; i < size(); ++i) {
    if (!is_active(i)) continue;
    double* e = &driving_[3 * i];
    const double mean = 0.5 * (e[0] + e[1]), half = scale_[i] * 0.5 * (e[0] - e[1]);
    e[0] = mean + half;
    e[1] = mean - half;
    e[2] *= scale_[i];
  }
  return driving_;
}

}  // namespace tailrun::fem

#include "fem_stage/material/residual_floor.hpp"

#include <algorithm>
#include <cmath>

namespace tailrun::fem {

ResidualFloor::ResidualFloor(std::vector<double> strength, std::span<const double> mobilisation_strain)
    : strength_(std::move(strength)),
      modulus_(strength_.size()),
      active_(strength_.size(), 0.0),
      committed_(2 * strength_.size(), 0.0),
      trial_(2 * strength_.size(), 0.0) {
  for (std::size_t i = 0; i < size(); ++i) modulus_[i] = strength_[i] / mobilisation_strain[i];
}

void ResidualFloor::activate(std::size_t point) {
  if (strength_[point] > 0.0) active_[point] = 1.0;
}

void ResidualFloor::update(std::span<const double> strain_increment, std::span<double> stress) {
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < size(); ++i) {
    if (!is_active(i)) continue;
    const double* e = &strain_increment[3 * i];
    double *s = &stress[4 * i], *b = &trial_[2 * i];
    b[0] = committed_[2 * i] + modulus_[i] * (e[0] - e[1]);
    b[1] = committed_[2 * i + 1] + modulus_[i] * e[2];
    const double carried = std::hypot(0.5 * (s[0] - s[1]), s[3]), left = std::max(0.0, strength_[i] - carried);
    if (const double radius = std::hypot(b[0], b[1]); radius > left) {
      b[0] *= left / radius;
      b[1] *= left / radius;
    }
    s[0] += b[0];
    s[1] -= b[0];
    s[3] += b[1];
  }
}

void ResidualFloor::restore(std::span<const double> stress, std::span<const double> active) {
  committed_.assign(stress.begin(), stress.end());
  active_.assign(active.begin(), active.end());
  trial_ = committed_;
}

}  // namespace tailrun::fem

// Strength that changes as the soil flows: softening with plastic strain, growth with shear rate.
#pragma once

#include <algorithm>
#include <cmath>

#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

// 1 at peak, 0 at residual.
inline double softening_share(const MaterialConstants& k, double plastic_strain) {
  const double x = std::max(0.0, plastic_strain - k.soften_start) / k.soften_scale;
  return k.exponential ? std::exp(-x) : std::max(0.0, 1.0 - x);
}

inline double softened_cohesion(const MaterialConstants& k, double peak, double share) {
  return peak * (k.cohesion_ratio + (1.0 - k.cohesion_ratio) * share);
}

inline double softened_sin_phi(const MaterialConstants& k, double share) {
  return k.sin_phi_residual + (k.sin_phi - k.sin_phi_residual) * share;
}

// Pa, strength added by the rate of shear `rate` (1/s, sqrt(2 e':e')): tau = tau_y + K rate^n.
inline double rate_strength(const MaterialConstants& k, double rate) {
  return k.exponent == 1.0 ? k.consistency * rate : k.consistency * std::pow(rate, k.exponent);
}

}  // namespace tailrun::mpm

// Strength that changes as the soil flows: softening with plastic strain, growth with shear rate.
#pragma once

#include <cmath>

#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

// `Real` is one particle's number or four particles'.

// 1 at peak, 0 at residual.
template <class Real>
[[gnu::always_inline]] inline Real softening_share(const MaterialConstants& k, Real plastic_strain) {
  const Real zero = {}, x = larger(zero, plastic_strain - k.soften_start) / k.soften_scale;
  return k.exponential ? per_lane([](double e) { return std::exp(-e); }, x) : larger(zero, 1.0 - x);
}

template <class Real>
[[gnu::always_inline]] inline Real softened_cohesion(const MaterialConstants& k, Real peak, Real share) {
  return peak * (k.cohesion_ratio + (1.0 - k.cohesion_ratio) * share);
}

// Pa, strength added by the rate of shear `rate` (1/s, sqrt(2 e':e')): tau = tau_y + K rate^n.
template <class Real>
[[gnu::always_inline]] inline Real rate_strength(const MaterialConstants& k, Real rate) {
  return k.exponent == 1.0 ? k.consistency * rate
                           : k.consistency * per_lane([n = k.exponent](double r) { return std::pow(r, n); }, rate);
}

}  // namespace tailrun::mpm

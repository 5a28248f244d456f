// Principal stresses s1 >= s2 >= s3 (tension positive) of one particle or of four, and what returns to a yield surface
// in them share: the tension cut-off and the plastic work.
#pragma once

#include <algorithm>
#include <cmath>

#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

// `Real` is one particle's number or four particles'.
template <class Real>
struct PrincipalOf {
  Real s1, s2, s3;
};
using Principal = PrincipalOf<double>;

// Principal tensions above T are cut off (Rankine planes, associated), then what still violates Mohr-Coulomb goes to
// the planes' intersection. `t` is the trial; called only where the Mohr-Coulomb return `s` has s1 > T.
inline Principal return_tension_cutoff(const MaterialConstants& e, double sin_phi, double c, double T, Principal t) {
  const double l = e.lambda, G2 = 2.0 * e.mu;
  const double k = (1.0 + sin_phi) / (1.0 - sin_phi);
  const double strength = 2.0 * c * std::sqrt(k);
  const double floor3 = k * T - strength;  // smallest s3 that Mohr-Coulomb allows with s1 = T
  Principal s = t;
  const double one = (t.s1 - T) / (l + G2);
  s = {T, t.s2 - l * one, t.s3 - l * one};
  if (s.s2 > T) {
    const double sum = (t.s1 + t.s2 - 2.0 * T) / (2.0 * l + G2);  // both plastic strains together
    s = {T, T, t.s3 - l * sum};
    if (s.s3 > T) return {T, T, T};
  }
  if (s.s3 < floor3) {
    const double sum = ((t.s1 - T) + (t.s3 - floor3)) / (2.0 * l + G2);
    const double s2 = std::clamp(t.s2 - l * sum, floor3, T);
    s = {T, s2, floor3};
  }
  return s;
}

// The lanes of `s` that lie above the tension cut-off, from their trial `t`. Seldom met.
inline void cut_off(const MaterialConstants& k, Vec4 sin_phi, Vec4 cohesion, const PrincipalOf<Vec4>& t,
                    PrincipalOf<Vec4>& s) {
  for (int l = 0; l < 4; ++l) {
    if (!(s.s1[l] > k.tension)) continue;
    const Principal r =
        return_tension_cutoff(k, sin_phi[l], cohesion[l], k.tension, Principal{t.s1[l], t.s2[l], t.s3[l]});
    s.s1[l] = r.s1;
    s.s2[l] = r.s2;
    s.s3[l] = r.s3;
  }
}

// Plastic strain increment from the stress that the return took away: de = C^-1 (s_trial - s). Returns the work s : de
// per unit volume and adds to the deviatoric plastic strain.
struct PlasticWork {
  Vec4 work, strain;
};

[[gnu::always_inline]] inline PlasticWork plastic_work(double shear_flexibility, double volume_flexibility,
                                                       const PrincipalOf<Vec4>& t, const PrincipalOf<Vec4>& s) {
  const Vec4 d1 = t.s1 - s.s1, d2 = t.s2 - s.s2, d3 = t.s3 - s.s3;
  const Vec4 mean = (d1 + d2 + d3) * (1.0 / 3.0), b = mean * volume_flexibility;
  const Vec4 e1 = shear_flexibility * (d1 - mean), e2 = shear_flexibility * (d2 - mean);
  const Vec4 e3 = shear_flexibility * (d3 - mean);
  return {s.s1 * (e1 + b) + s.s2 * (e2 + b) + s.s3 * (e3 + b), root(2.0 / 3.0 * (e1 * e1 + e2 * e2 + e3 * e3))};
}

}  // namespace tailrun::mpm

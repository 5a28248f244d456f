// Closed-form return to the Mohr-Coulomb pyramid and to the Tresca prism in principal stresses s1 >= s2 >= s3 (tension
// positive), without branches so that loops over particles become vector code.
//
// Clausen, Damkilde & Andersen (2006, 2007): plane k s1 - s3 = s_c with k = (1 + sin phi) / (1 - sin phi), s_c = 2 c
// sqrt(k); potential m s1 - s3, m from psi; edges s = s_a + t (1, k, k) (s2 = s3) and s_a + t (1, 1, k) (s1 = s2), apex
// s_a = s_c / (k - 1). Plastic strains off an edge are normal to the potential's edge r_g, so t = r_g D^-1 (s - s_a) /
// (r_g D^-1 r_l).
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

// What the return needs of elasticity, friction and dilation, with every quotient worked out beforehand: friction that
// does not soften costs no division per particle.
template <class Real>
struct MohrCoulombSurfaceOf {
  Real k, root2;          // root2 = 2 sqrt(k)
  Real apex;              // apex stress per unit of s_c
  Real D1, D2, D3;        // D b over a D b
  Real a1, a23, b12, b3;  // coordinates of a stress along the two edges
};
using MohrCoulombSurface = MohrCoulombSurfaceOf<double>;

template <class Real>
[[gnu::always_inline]] inline MohrCoulombSurfaceOf<Real> mohr_coulomb_surface(const MaterialConstants& e,
                                                                              Real sin_phi) {
  const double l = e.lambda, G2 = 2.0 * e.mu, m = e.m;
  MohrCoulombSurfaceOf<Real> s;
  s.k = (1.0 + sin_phi) / (1.0 - sin_phi);
  s.root2 = 2.0 * root(s.k);
  s.apex = 1.0 / (s.k - 1.0);
  // D b = ((l + 2G) m - l, l (m - 1), l m - (l + 2G)), a = (k, 0, -1).
  const double D1 = (l + G2) * m - l, D2 = l * (m - 1.0), D3 = l * m - (l + G2);
  const Real r = 1.0 / (s.k * D1 - D3);
  s.D1 = D1 * r;
  s.D2 = D2 * r;
  s.D3 = D3 * r;
  // D^-1 r is proportional to r (1 + nu) - nu tr(r), and 2 nu = l / (l + G).
  const double nu = 0.5 * l / (l + 0.5 * G2);
  const double tr_a = 1.0 + 2.0 * m, a1 = 1.0 + nu - nu * tr_a, a2 = m * (1.0 + nu) - nu * tr_a;
  const double tr_b = 2.0 + m, b1 = 1.0 + nu - nu * tr_b, b3 = m * (1.0 + nu) - nu * tr_b;
  const Real ra = 1.0 / (a1 + 2.0 * a2 * s.k), rb = 1.0 / (2.0 * b1 + b3 * s.k);
  s.a1 = a1 * ra;
  s.a23 = a2 * ra;
  s.b12 = b1 * rb;
  s.b3 = b3 * rb;
  return s;
}

// Returns the stress on or inside the yield surface. `c` Pa. Any trial stress is admissible.
template <class Surface, class Real>
[[gnu::always_inline]] inline PrincipalOf<Real> return_mohr_coulomb(const MohrCoulombSurfaceOf<Surface>& e, Real c,
                                                                    PrincipalOf<Real> t) {
  const Real zero = {}, strength = e.root2 * c, f = e.k * t.s1 - t.s3 - strength;
  const Real p1 = t.s1 - f * e.D1, p2 = t.s2 - f * e.D2, p3 = t.s3 - f * e.D3;
  const Real apex = strength * e.apex;
  const Real d1 = t.s1 - apex, d2 = t.s2 - apex, d3 = t.s3 - apex;
  // Where the plane's return is not ordered, the edge that the trial leans towards decides; beyond its end lies the
  // apex.
  const Real ta = smaller<Real>(e.a1 * d1 + e.a23 * (d2 + d3), zero);
  const Real tb = smaller<Real>(e.b12 * (d1 + d2) + e.b3 * d3, zero);
  const auto lower = p2 - p3 < p1 - p2;
  const Real along1 = lower ? ta : tb, along2 = lower ? e.k * ta : tb;
  const Real q1 = apex + along1, q2 = apex + along2, q3 = apex + e.k * along1;
  const auto ordered = (p1 >= p2) & (p2 >= p3), yields = f > zero;
  const Real r1 = ordered ? p1 : q1, r2 = ordered ? p2 : q2, r3 = ordered ? p3 : q3;
  return {yields ? r1 : t.s1, yields ? r2 : t.s2, yields ? r3 : t.s3};
}

// phi = 0, volume-preserving flow: s1 - s3 = 2 c, on the plane s2 keeps its value, on an edge it joins s1 or s3; the
// mean stress never changes.
template <class Real>
[[gnu::always_inline]] inline PrincipalOf<Real> return_tresca(Real c, PrincipalOf<Real> t) {
  const Real excess = t.s1 - t.s3 - 2.0 * c;
  const Real p1 = t.s1 - 0.5 * excess, p3 = t.s3 + 0.5 * excess;
  const Real mean = (t.s1 + t.s2 + t.s3) * (1.0 / 3.0), third = 2.0 / 3.0 * c;
  const auto above = t.s2 > p1, below = t.s2 < p3;
  const Real q1 = above ? mean + third : (below ? mean + 2.0 * third : p1);
  const Real q2 = above ? mean + third : (below ? mean - third : t.s2);
  const Real q3 = above ? mean - 2.0 * third : (below ? mean - third : p3);
  const auto yields = excess > Real{};
  return {yields ? q1 : t.s1, yields ? q2 : t.s2, yields ? q3 : t.s3};
}

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

}  // namespace tailrun::mpm

// Geometry of the thin yield cone |s - p alpha| = sqrt(1/2) m p: where an elastic path leaves it, how a state is
// brought back onto it, and what happens at the lowest stress that the model carries (p_min/5; there is no tensile
// strength).
#pragma once

#include <algorithm>

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

constexpr double stress_floor_fraction = 0.2;  // of p_min

// Fraction t in [0, 1] of the elastic path (p, s) + t (dp, ds) at which it leaves the cone; 1 when it stays inside.
// |s - p alpha|^2 - m^2 p^2/2 is quadratic in t while alpha is fixed, so the crossing is closed-form, also when the
// step goes right through the cone. `on_surface`: the path starts on the cone and points into it.
inline double cone_exit(double m, double p, Deviator s, Deviator alpha, double dp, Deviator ds, bool on_surface) {
  const Deviator r0 = s - p * alpha;
  const Deviator r1 = ds - dp * alpha;
  const double radius = 0.5 * m * m;
  const double a = contract(r1, r1) - radius * dp * dp;
  const double b = contract(r0, r1) - radius * p * dp;
  const double c = on_surface ? 0.0 : contract(r0, r0) - radius * p * p;
  double t = 1.0;
  if (on_surface) {
    if (a > 0.0 && b < 0.0) t = -2.0 * b / a;
    if (b >= 0.0) t = 0.0;
  } else if (c < 0.0) {
    const double discriminant = b * b - a * c;
    if (discriminant >= 0.0) {
      // The smallest positive root, in the form that does not cancel.
      const double root = std::sqrt(discriminant);
      const double q = -(b + std::copysign(root, b));
      const double t1 = a != 0.0 ? q / a : 2.0;
      const double t2 = q != 0.0 ? c / q : 2.0;
      t = 2.0;
      if (t1 > 0.0) t = t1;
      if (t2 > 0.0) t = std::min(t, t2);
    }
  } else {
    t = 0.0;
  }
  return std::clamp(t, 0.0, 1.0);
}

// Keeps p >= p_min/5. Inside the cone only p is raised. Outside, the direction of s is kept and q/p brought down to
// 0.8 M with alpha on the stress (OpenSees instead forces s_xy = alpha_xy p = 0.8 M p whatever the direction was).
// Returns whether it acted.
inline bool hold_stress_floor(const Pm4Law& law, const Pm4PointConstants& point, Pm4Variables& v) {
  const double floor = stress_floor_fraction * point.p_min;
  if (v.p >= floor) return false;
  const bool inside = yield_function(law.m, v.p, v.s, v.alpha) <= 0.0;
  v.p = floor;
  if (inside) return true;
  if (law.compatibility == Pm4Compatibility::opensees) {
    v.alpha = {0.0, 0.8 * law.M};
    v.s = floor * v.alpha;
    return true;
  }
  const double length = norm(v.s);
  const double allowed = sqrt_half * 0.8 * law.M * floor;
  if (length > allowed) v.s = (allowed / length) * v.s;
  v.alpha = (1.0 / floor) * v.s;
  return true;
}

// Moves alpha along the cone's normal so that the stress lies exactly on the cone. Always works.
inline void recentre_cone(const Pm4Law& law, Pm4Variables& v) {
  const Deviator n = cone_normal(v.p, v.s, v.alpha);
  v.alpha = (1.0 / v.p) * v.s - (sqrt_half * law.m) * n;
}

// Scales s so that q/p = M_b at constant p and puts alpha on the same ray. Returns whether it acted.
inline bool clip_to_bounding_surface(const Pm4Law& law, const Pm4PointConstants& point, double M_b, Pm4Variables& v) {
  if (law.bounding_clip == Pm4BoundingClip::simple_shear && std::fabs(v.s.d) >= 5e-8 * law.atmospheric_pressure) {
    return false;
  }
  const double q = sqrt_two * norm(v.s);
  const bool opensees = law.compatibility == Pm4Compatibility::opensees;
  const double limit = M_b * (opensees ? std::max(v.p, point.p_min) : v.p);
  if (q <= limit) return false;
  v.s = (limit / q) * v.s;
  v.alpha = ((M_b - law.m) / (M_b * v.p)) * v.s;
  return true;
}

}  // namespace tailrun::fem

// One semi-implicit Euler step of PM4, for four points at once: stress, back-stress ratio, n and fabric implicit, which
// comes down to one scalar equation as in the radial return for Armstrong-Frederick hardening; dilatancy and moduli of
// the step's start.
#pragma once

#include "fem_stage/material/pm4_rates.hpp"
#include "fem_stage/material/pm4_yield_cone.hpp"

namespace tailrun::fem::pm4_detail {

constexpr double fading_distance = 0.02;  // of alpha from the bounding surface
// A Newton step that changes its unknown by less than this share is the last one: what it leaves is of the order of the
// share's square, and the error estimate sees it.
constexpr double settled = 0.1;
constexpr int most_iterations = 20;

struct ImplicitStep {
  Pm4VariablesOf<Lanes> v;
  DeviatorOf<Lanes> n;
  Lanes x = 0.0;  // plastic shear
  LaneMask plastic{};
};

// What a semi-implicit step takes from its start: one evaluation serves the whole step and the first half.
struct StepStart {
  Pm4ModuliOf<Lanes> moduli;
  DeviatorOf<Lanes> n;  // of the yield cone
  Pm4CoefficientsOf<Lanes> c;
  Lanes beta;  // sqrt(1/2) (M_b - m): alpha^b = beta n
  Lanes inverse_G;
  Lanes n_r;                 // n:r
  Lanes hardening;           // H/p*
  Lanes inverse_B;           // 1/|B|
  Lanes inverse_resistance;  // of the explicit loading index, 1/Pa
  LaneMask forms_fabric;
  Lanes p_min_slope;  // of the dilatancy over p near p_min, 1/Pa
};

template <class Law>
StepStart step_start(const Law& law, const Pm4PlaceOf<Lanes>& at) {
  StepStart out;
  out.moduli = at.moduli;
  out.n = at.n;
  out.c = coefficients(law, at);
  const Pm4DilatancyOf<Lanes>& D = out.c.dilatancy;
  out.beta = sqrt_half * (at.surfaces.M_b - law.m);
  out.inverse_G = 1.0 / at.moduli.G;
  const Lanes p_star = number::max(at.v.p, at.point.p_min);
  out.n_r = contract(at.n, at.v.s) / at.v.p;
  out.hardening = out.c.H / p_star;
  const Lanes D_start = D.at(p_star);
  const Lanes size_B = number::max(number::abs(out.c.B), Lanes(1e-14));
  out.inverse_B = 1.0 / size_B;
  const Lanes resistance = 2.0 * at.moduli.G + out.c.H * number::sqrt(size_B) - at.moduli.K * D_start * out.n_r;
  out.inverse_resistance = 1.0 / number::max(resistance, 0.1 * at.moduli.G);
  out.forms_fabric = (out.c.fabric_rate > 0.0) & (D_start < 0.0);
  out.p_min_slope = select(D.contraction, D.free / D.p_fade, 2.0 * D.limit / D.two_p_min);
  return out;
}

// p after a plastic shear x: p = p_trial - x K D(p), in closed form because D(p) is piecewise linear.
inline Lanes implicit_pressure(const StepStart& start, Lanes p_trial, Lanes xK) {
  const Pm4DilatancyOf<Lanes>& D = start.c.dilatancy;
  const Lanes p_free = p_trial - xK * D.free;
  const Lanes fades = D.two_p_min + D.p_fade;
  if (!any(p_free < fades)) return p_free;
  const Lanes a = xK * start.p_min_slope;
  const Lanes faded = (p_trial + a * D.two_p_min) / (1.0 + a);
  const LaneMask low = p_trial <= D.two_p_min;
  const Lanes contracting = select(low, p_trial, select(p_free >= fades, p_free, faded));
  const Lanes dilating = number::max(p_free, select(p_trial >= D.two_p_min, D.two_p_min, faded));
  return select(D.contraction, contracting, dilating);
}

inline Lanes length(const PlaneStrainOf<Lanes>& strain) {
  return number::sqrt(strain.volumetric * strain.volumetric + contract(strain.deviator, strain.deviator));
}

// The explicit loading index over `strain`, which may be negative.
inline Lanes explicit_shear(const StepStart& start, const PlaneStrainOf<Lanes>& strain, Lanes dp_trial) {
  return (2.0 * start.moduli.G * contract(start.n, strain.deviator) - start.n_r * dp_trial) * start.inverse_resistance;
}

// A step over `strain` from `v`.
template <class Law>
ImplicitStep implicit_euler(const Law& law, const Pm4PointConstantsOf<Lanes>& point, const Pm4VariablesOf<Lanes>& v,
                            const StepStart& start, const PlaneStrainOf<Lanes>& strain) {
  ImplicitStep out;
  const Lanes G = start.moduli.G;
  const Lanes K = start.moduli.K;
  const Pm4CoefficientsOf<Lanes>& c = start.c;
  const Lanes floor = stress_floor_fraction * point.p_min;
  const double cone = sqrt_half * law.m;
  const Lanes beta = start.beta;
  const DeviatorOf<Lanes> s_trial = v.s + 2.0 * G * strain.deviator;
  const Lanes p_elastic = v.p + (K + (1.0 / 3.0) * G) * strain.volumetric;
  // Where G/3 de_v pushes the stress out of the cone, the published loading index (with K) leaves it to the yield
  // correction, which moves alpha; where it sinks the stress into the cone, the limit of small steps has K + G/3. Near
  // the bounding surface alpha has nowhere to go, so the former fades into the latter.
  const Lanes left_to_alpha =
      select(start.n_r * strain.volumetric < 0.0, clamp_to<Lanes>(c.B * (1.0 / fading_distance), 0.0, 1.0), Lanes(0.0));
  const Lanes p_left = left_to_alpha * (1.0 / 3.0) * G * strain.volumetric;
  const Lanes p_trial = p_elastic - p_left;
  const Lanes p_start = number::max(p_trial, floor);
  const DeviatorOf<Lanes> radius = s_trial - p_start * v.alpha;
  const Lanes radius_squared = contract(radius, radius);
  out.plastic = radius_squared > square(cone * p_start);

  // F(x) = |eta| - 2 G x - p w beta/(1 + w) - sqrt(1/2) m p = 0 with eta = s_trial - p alpha/(1 + w), n = eta/|eta|;
  // w = x K_p/(p B) at the end of the step, where B has relaxed by 1/(1 + w): w^2 = g^2 (1 + w).
  Lanes share = 1.0;  // 1/(1 + w)
  DeviatorOf<Lanes> n = start.n;
  Lanes alpha_n = 0.0;
  Lanes inverse_B = start.inverse_B;
  const Lanes x_most = 2.0 * length(strain) + number::sqrt(radius_squared) * start.inverse_G;
  // The first guess is the explicit loading index; a share of the most possible where the normal turns right round.
  Lanes x = clamp_to<Lanes>(explicit_shear(start, strain, p_trial - v.p), 1e-3 * x_most, x_most);
  LaneMask open = out.plastic;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Lanes g2 = square(start.hardening * x) * inverse_B;
    const Lanes root = number::sqrt(g2 * (g2 + 4.0));
    const Lanes one_w = 1.0 + 0.5 * (g2 + root);
    const Lanes inverse = 1.0 / (one_w * number::max(root, Lanes(1e-300)));
    share = select(open, root * inverse, share);
    const Lanes p = number::max(implicit_pressure(start, p_trial, x * K), floor);
    const DeviatorOf<Lanes> eta = s_trial - (p * share) * v.alpha;
    const Lanes eta_length = norm(eta);
    n = select(open, (1.0 / number::max(eta_length, Lanes(1e-300))) * eta, n);
    alpha_n = contract(v.alpha, n);
    const Lanes held = (1.0 - share) * beta + cone;
    const Lanes F = eta_length - 2.0 * G * x - p * held;
    // x dw/dx from w^2 = g^2 (1 + w), x dp/dx from the dilatancy as it acted.
    const Lanes x_dw = 2.0 * g2 * one_w * (one_w * inverse);
    const Lanes x_dp = p - p_start;
    const Lanes x_slope = -2.0 * G * x - p * x_dw * share * share * (beta - alpha_n) - x_dp * (share * alpha_n + held);
    const Lanes next = clamp_to<Lanes>(x - F * x / number::min(x_slope, -0.2 * G * x), 1e-3 * x, x_most);
    const LaneMask moving = open & (number::abs(next - x) > settled * x);
    x = select(open, next, x);
    open = moving;
    if (!any(open)) break;
    inverse_B = select(open, 1.0 / number::max(number::abs(beta - alpha_n), Lanes(1e-14)), inverse_B);
  }
  out.x = select(out.plastic, x, Lanes(0.0));
  const Lanes p_end = number::max(implicit_pressure(start, p_trial, x * K), floor) + p_left;
  out.v.p = number::max(select(out.plastic, p_end, p_elastic), floor);

  const LaneMask correcting = out.plastic & (left_to_alpha > 0.0);
  if (any(correcting)) {
    // With x known, alpha moves on along b until f = 0 at the true p: |s_trial - y p alpha| = 2 G x + p ((1 - y) beta +
    // sqrt(1/2) m), whose slope in y = 1/(1 + w) is p B. The first guess counts p_left, of which F knew nothing.
    const Lanes slope = out.v.p * number::max(beta - alpha_n, Lanes(1e-3));
    Lanes y = clamp_to<Lanes>(share + p_left * start.n_r / slope, 0.0, 1.0);
    open = correcting;
    for (int iteration = 0; iteration < 4 && any(open); ++iteration) {
      const DeviatorOf<Lanes> eta = s_trial - (y * out.v.p) * v.alpha;
      const Lanes eta_length = norm(eta);
      n = select(open, (1.0 / number::max(eta_length, Lanes(1e-300))) * eta, n);
      const Lanes residual = eta_length - 2.0 * G * x - out.v.p * ((1.0 - y) * beta + cone);
      const Lanes along = out.v.p * number::max(beta - contract(v.alpha, n), Lanes(1e-3));
      const Lanes next = clamp_to<Lanes>(y - residual / along, 0.0, 1.0);
      const LaneMask moving = open & (number::abs(next - y) > settled * (1.0 - y));
      y = select(open, next, y);
      open = moving;
    }
  }
  out.n = n;
  out.v.s = s_trial - (2.0 * G * out.x) * n;
  out.v.alpha = select(out.plastic, (1.0 / out.v.p) * out.v.s - cone * n, v.alpha);
  const LaneMask inside = !out.plastic;
  if (any(inside)) {
    // Inside the cone at p_trial, but not with p_left, which alpha follows.
    const DeviatorOf<Lanes> outward = s_trial - out.v.p * v.alpha;
    const Lanes distance = norm(outward);
    const LaneMask crossing = inside & (left_to_alpha > 0.0) & (distance > cone * out.v.p);
    out.n = select(crossing, (1.0 / number::max(distance, Lanes(1e-300))) * outward, out.n);
    out.v.alpha = select(crossing, (1.0 / out.v.p) * s_trial - cone * out.n, out.v.alpha);
  }
  out.v.z = v.z;
  out.v.z_cum = v.z_cum;
  if (any(start.forms_fabric)) {
    const Lanes wz = select(start.forms_fabric, c.fabric_rate * out.x, Lanes(0.0));
    const DeviatorOf<Lanes> change = (-wz / (1.0 + wz)) * (point.z_max * n + v.z);
    out.v.z = v.z + change;
    out.v.z_cum = v.z_cum + sqrt_half * norm(change);
  }
  return out;
}

}  // namespace tailrun::fem::pm4_detail

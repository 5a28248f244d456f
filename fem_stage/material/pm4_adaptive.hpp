// Integration by error alone. Two things make the rate equations stiff once soil flows: the cone is so thin that its
// normal n turns to the strain direction within a strain of m p/G, and at the bounding surface the plastic modulus
// ~ sqrt(B) has an infinite slope. Explicit schemes then need thousands of sub-steps. Here every sub-step is a
// semi-implicit Euler step: stress, back-stress ratio, n and fabric implicit, which comes down to one scalar equation
// as in the radial return for Armstrong-Frederick hardening; dilatancy and moduli of the step's start. One whole and
// two half steps give the error and, extrapolated, second order (Deuflhard 1985). Reversals, fabric records and the
// bounding-surface clip are followed sub-step by sub-step, so that the answer does not depend on the caller's steps.
#pragma once

#include "fem_stage/material/pm4_memory.hpp"
#include "fem_stage/material/pm4_rates.hpp"
#include "fem_stage/material/pm4_yield_cone.hpp"

namespace tailrun::fem {

struct Pm4AdaptiveOptions {
  double tolerance = 1e-3;      // relative error of the un-extrapolated stress (and z/z_max) in one sub-step
  double stress_scale = 0.005;  // of p_A: errors are relative to at least this stress
  double largest_growth = 5.0;  // of a sub-step over the one before
  double discontinuity = 30.0;  // times the tolerance, where the rates jump and shorter sub-steps do not help
  double smallest = 1e-9;       // strain; a sub-step this short is accepted as it is
  double elastic_change = 0.2;  // largest relative change of p in one elastic sub-step
  long full_accuracy = 300;    // sub-steps of one update; beyond it the tolerance grows with the square of their number
  long most_substeps = 20000;  // in one update; beyond it the update reports failure
};

namespace pm4_detail {

constexpr double fading_distance = 0.02;  // of alpha from the bounding surface

inline double length(const PlaneStrain& strain) {
  return std::sqrt(strain.volumetric * strain.volumetric + contract(strain.deviator, strain.deviator));
}

struct ImplicitStep {
  Pm4Variables v;
  Deviator n;
  bool plastic = false;
};

// p after a plastic shear x: p = p_trial - x K D(p), in closed form because D(p) is piecewise linear.
inline double implicit_pressure(const Pm4Dilatancy& D, double p_trial, double xK) {
  const double p_free = p_trial - xK * D.free;
  if (D.contraction) {
    if (p_free >= D.two_p_min + D.p_fade || p_trial <= D.two_p_min) return p_trial <= D.two_p_min ? p_trial : p_free;
    const double a = xK * D.free / D.p_fade;
    return (p_trial + a * D.two_p_min) / (1.0 + a);
  }
  if (p_trial >= D.two_p_min) return std::max(p_free, std::min(p_trial, D.two_p_min));
  const double a = 2.0 * xK * D.limit / D.two_p_min;
  return std::max(p_free, (p_trial + a * D.two_p_min) / (1.0 + a));
}

// What a semi-implicit step takes from its start: one evaluation serves the whole step and the first half.
struct StepStart {
  Pm4Moduli moduli;
  Deviator n;  // of the yield cone
  Pm4Coefficients c;
  double beta = 0.0;                // sqrt(1/2) (M_b - m): alpha^b = beta n
  double p_star = 0.0;              // max(p, p_min)
  double n_r = 0.0;                 // n:r
  double alpha_n = 0.0;             // alpha:n
  double hardening_squared = 0.0;   // (H/p*)^2
  double inverse_B = 0.0;           // 1/|B|
  double inverse_resistance = 0.0;  // of the explicit loading index, 1/Pa
};

template <class Law>
StepStart step_start(const Law& law, const Pm4PointConstants& point, const Pm4State& state, const Pm4Variables& v,
                     const Pm4Surfaces& surfaces, const Pm4Moduli& moduli, Deviator n) {
  StepStart out;
  const double z_peak = std::max(state.z_peak, sqrt_half * norm(v.z));
  out.moduli = moduli;
  out.n = n;
  out.c = coefficients(law, point, state.memory, z_peak, v, surfaces, moduli, n);
  out.beta = sqrt_half * (surfaces.M_b - law.m);
  out.p_star = std::max(v.p, point.p_min);
  out.n_r = contract(n, v.s) / v.p;
  out.alpha_n = out.beta - out.c.B;
  out.hardening_squared = square(out.c.H / out.p_star);
  const double size_B = std::max(std::fabs(out.c.B), 1e-14);
  out.inverse_B = 1.0 / size_B;
  const double resistance =
      2.0 * moduli.G + out.c.H * std::sqrt(size_B) - moduli.K * out.c.dilatancy.at(out.p_star) * out.n_r;
  out.inverse_resistance = 1.0 / std::max(resistance, 0.1 * moduli.G);
  return out;
}

// One semi-implicit Euler step over `strain` from `v`.
template <class Law>
ImplicitStep implicit_euler(const Law& law, const Pm4PointConstants& point, const Pm4Variables& v,
                            const StepStart& start, const PlaneStrain& strain) {
  ImplicitStep out;
  const double G = start.moduli.G;
  const double K = start.moduli.K;
  const Pm4Coefficients& c = start.c;
  const double floor = stress_floor_fraction * point.p_min;
  const double cone = sqrt_half * law.m;
  const double beta = start.beta;
  const Deviator s_trial = v.s + 2.0 * G * strain.deviator;
  const double p_elastic = v.p + (K + G / 3.0) * strain.volumetric;
  // Where G/3 de_v pushes the stress out of the cone, the published loading index (with K) leaves it to the yield
  // correction, which moves alpha; where it sinks the stress into the cone, the limit of small steps has K + G/3. Near
  // the bounding surface alpha has nowhere to go, so the former fades into the latter.
  const double left_to_alpha = start.n_r * strain.volumetric < 0.0 ? std::clamp(c.B / fading_distance, 0.0, 1.0) : 0.0;
  const double p_trial = p_elastic - left_to_alpha * G / 3.0 * strain.volumetric;

  out.v = v;
  out.v.s = s_trial;
  out.v.p = std::max(p_elastic, floor);
  out.n = start.n;
  const double p_start = std::max(p_trial, floor);
  const Deviator radius = s_trial - p_start * v.alpha;
  const double radius_squared = contract(radius, radius);
  if (radius_squared <= square(cone * p_start)) {
    if (left_to_alpha > 0.0 && yield_function(law.m, out.v.p, out.v.s, out.v.alpha) > 0.0) {
      out.n = cone_normal(out.v.p, out.v.s, out.v.alpha);
      recentre_cone(law, out.v);
    }
    return out;
  }

  // F(x) = |eta| - 2 G x - p w beta/(1 + w) - sqrt(1/2) m p = 0 with eta = s_trial - p alpha/(1 + w), n = eta/|eta|;
  // w = x K_p/(p B) at the end of the step, where B has relaxed by 1/(1 + w): w^2 = g^2 (1 + w).
  double w = 0.0;
  double p = p_start;
  Deviator n = start.n;
  double inverse_B = start.inverse_B;
  const double x_most = 2.0 * length(strain) + std::sqrt(radius_squared) / G;
  // The first guess is the explicit loading index; a share of the most possible where the normal turns right round.
  const double L = (2.0 * G * contract(n, strain.deviator) - start.n_r * (p_trial - v.p)) * start.inverse_resistance;
  double x = std::clamp(L, 1e-3 * x_most, x_most);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double g2 = start.hardening_squared * x * x * inverse_B;
    w = 0.5 * (g2 + std::sqrt(g2 * (g2 + 4.0)));
    p = std::max(implicit_pressure(c.dilatancy, p_trial, x * K), floor);
    const double share = 1.0 / (1.0 + w);
    const Deviator eta = s_trial - (p * share) * v.alpha;
    const double eta_length = norm(eta);
    n = (1.0 / std::max(eta_length, 1e-300)) * eta;
    const double alpha_n = contract(v.alpha, n);
    const double held = w * share * beta + cone;
    const double F = eta_length - 2.0 * G * x - p * held;
    if (std::fabs(F) <= 1e-7 * p) break;
    // x dw/dx from w^2 = g^2 (1 + w), x dp/dx from the dilatancy as it acted.
    const double x_dw = w > 0.0 ? 2.0 * g2 * (1.0 + w) / (2.0 * w - g2) : 0.0;
    const double x_dp = p - p_start;
    const double x_slope = -2.0 * G * x - p * x_dw * share * share * (beta - alpha_n) - x_dp * (share * alpha_n + held);
    x = std::clamp(x - F * x / std::min(x_slope, -0.2 * G * x), 1e-3 * x, x_most);
    inverse_B = 1.0 / std::max(std::fabs(beta - alpha_n), 1e-14);
  }
  out.plastic = true;
  out.v.p = std::max(p + (p_elastic - p_trial), floor);
  if (left_to_alpha > 0.0) {
    // With x known, alpha moves on along b until f = 0 at the true p: |s_trial - y p alpha| = 2 G x + p ((1 - y) beta +
    // sqrt(1/2) m), whose slope in y = 1/(1 + w) is p B.
    double y = 1.0 / (1.0 + w);
    for (int iteration = 0; iteration < 4; ++iteration) {
      const Deviator eta = s_trial - (y * out.v.p) * v.alpha;
      const double eta_length = norm(eta);
      n = (1.0 / std::max(eta_length, 1e-300)) * eta;
      const double residual = eta_length - 2.0 * G * x - out.v.p * ((1.0 - y) * beta + cone);
      if (std::fabs(residual) <= 1e-9 * out.v.p) break;
      const double slope = out.v.p * std::max(beta - contract(v.alpha, n), 1e-3);
      y = std::clamp(y - residual / slope, 0.0, 1.0);
    }
  }
  out.n = n;
  out.v.s = s_trial - (2.0 * G * x) * n;
  out.v.alpha = (1.0 / out.v.p) * out.v.s - cone * n;
  if (c.fabric_rate > 0.0 && c.dilatancy.at(start.p_star) < 0.0) {
    const double wz = c.fabric_rate * x;
    const Deviator change = (-wz / (1.0 + wz)) * (point.z_max * n + v.z);
    out.v.z = v.z + change;
    out.v.z_cum = v.z_cum + sqrt_half * norm(change);
  }
  return out;
}

// Everything of one update that its sub-steps share.
template <class Law>
struct Update {
  const Law& law;
  const Pm4PointConstants& point;
  const Pm4AdaptiveOptions& options;
  PlaneStrain strain;    // whole increment
  double strain_length;  // its norm
  Pm4State& state;
  double index_start;
  double index_rate;
  double done = 0.0;
  double fraction = 1.0;  // next sub-step to try
  long substeps = 0;

  Pm4Surfaces surfaces_at(const Pm4Variables& v, double t) const {
    return law.surfaces(point, std::max(v.p, point.p_min), index_start + index_rate * t);
  }
  void note_reversal(Deviator n) {
    if (reversed(state.memory, state.v.alpha, n)) {
      record_reversal(point, state.v.p, state.v.alpha, state.v.z, n, state.memory);
    }
  }
};

// An elastic sub-step from inside the cone, or from the cone into it: to the cone's far side, or as far as the modulus
// stays nearly the same. The modulus is the midpoint's, so the sub-step is of second order in the change of p. Returns
// false, and does nothing, when with that modulus the path leaves the cone at once.
template <class Law>
bool elastic_substep(Update<Law>& u, const Pm4Moduli& moduli, bool on_surface) {
  Pm4Variables& v = u.state.v;
  const double rest = 1.0 - u.done;
  const double floor = stress_floor_fraction * u.point.p_min;
  const double rate = (moduli.K + moduli.G / 3.0) * u.strain.volumetric;
  const double most = u.options.elastic_change * std::max(v.p, u.point.p_min);
  const bool at_floor = v.p <= floor && rate < 0.0;
  double step = rest;
  if (!at_floor && std::fabs(rate) * step > most) step = most / std::fabs(rate);
  Pm4Variables change = elastic_change(moduli, u.strain);
  if (std::fabs(rate) * step > 0.01 * v.p && !at_floor) {
    const double p_half = std::max(v.p + 0.5 * step * change.p, floor);
    const Deviator s_half = v.s + 0.5 * step * change.s;
    Pm4Variables half = v;
    half.p = p_half;
    const Pm4Moduli midpoint =
        moduli_of(u.law, u.point, u.surfaces_at(half, u.done + 0.5 * step), p_half, s_half, v.z_cum);
    change = elastic_change(midpoint, u.strain);
  }
  if (at_floor) change.p = 0.0;
  const double exit = cone_exit(u.law.m, v.p, v.s, v.alpha, step * change.p, step * change.s, on_surface);
  if (exit == 0.0) return false;
  const double taken = exit * step;
  v.p = std::max(v.p + taken * change.p, floor);
  v.s = v.s + taken * change.s;
  u.done = exit < 1.0 || step < rest ? u.done + taken : 1.0;
  u.note_reversal(cone_normal(v.p, v.s, v.alpha));
  return true;
}

// A sub-step on the cone with error control.
template <class Law>
void plastic_substep(Update<Law>& u, const StepStart& start) {
  const Pm4AdaptiveOptions& o = u.options;
  Pm4Variables& v = u.state.v;
  const double stress_scale = o.stress_scale * u.law.atmospheric_pressure;
  const double least = std::min(1.0, o.smallest / u.strain_length);
  // An increment far outside what the error control was made for must end, too.
  const double tolerance =
      std::min(0.1, o.tolerance * std::max(1.0, square(static_cast<double>(u.substeps) / o.full_accuracy)));
  double h_before = 0.0;
  double error_before = 0.0;
  for (;;) {
    const double rest = 1.0 - u.done;
    const bool last = u.fraction >= rest;
    const double h = last ? rest : u.fraction;
    const PlaneStrain whole{h * u.strain.volumetric, h * u.strain.deviator};
    const PlaneStrain half{0.5 * whole.volumetric, 0.5 * whole.deviator};
    const ImplicitStep a = implicit_euler(u.law, u.point, v, start, whole);
    const ImplicitStep b1 = implicit_euler(u.law, u.point, v, start, half);
    const Pm4Surfaces surfaces = u.surfaces_at(b1.v, u.done + 0.5 * h);
    const Pm4Moduli moduli = moduli_of(u.law, u.point, surfaces, b1.v.p, b1.v.s, b1.v.z_cum);
    const StepStart middle = step_start(u.law, u.point, u.state, b1.v, surfaces, moduli, b1.n);
    const ImplicitStep b = implicit_euler(u.law, u.point, b1.v, middle, half);
    const double dp = b.v.p - a.v.p;
    const Deviator ds = b.v.s - a.v.s;
    const Deviator dz = b.v.z - a.v.z;
    const double size_squared = std::max(2.0 * b.v.p * b.v.p + contract(b.v.s, b.v.s), stress_scale * stress_scale);
    const double error = std::sqrt(std::max((2.0 * dp * dp + contract(ds, ds)) / size_squared,
                                            contract(dz, dz) / (u.point.z_max * u.point.z_max)));
    const double factor = std::min(0.9 * std::sqrt(tolerance / std::max(error, 1e-30)), o.largest_growth);
    // Dilatancy jumps where contraction turns into dilation below 2 p_min; a state that slides along the jump has an
    // error proportional to h (not h^2) that does not accumulate.
    const bool jump = h_before > 0.0 && error <= o.discontinuity * tolerance &&
                      error * h_before * std::sqrt(std::sqrt(h_before)) > error_before * h * std::sqrt(std::sqrt(h));
    if (!(error <= tolerance) && !jump && h > least) {
      u.fraction = std::max(h * std::clamp(factor, 0.1, 0.5), least);
      h_before = h;
      error_before = error;
      ++u.substeps;
      continue;
    }
    v = b.v;
    if (a.plastic && b1.plastic && b.plastic) {
      v.p = std::max(b.v.p + dp, stress_floor_fraction * u.point.p_min);
      v.s = b.v.s + ds;
      v.z = b.v.z + dz;
      v.z_cum = std::max(2.0 * b.v.z_cum - a.v.z_cum, b1.v.z_cum);
      const Deviator n = 2.0 * b.n - a.n;
      v.alpha = (1.0 / v.p) * v.s - (sqrt_half * u.law.m / norm(n)) * n;
    }
    u.done = last ? 1.0 : u.done + h;
    // A last sub-step cut short by the end of the increment says nothing against the longer one planned before.
    const double next = h * (jump ? 1.0 : std::max(factor, 0.2));
    u.fraction = std::max({next, least, last && factor > 1.0 ? u.fraction : 0.0});
    return;
  }
}

}  // namespace pm4_detail

// The state at the end of the strain increment (compression positive) from the committed one. Returns the number of
// sub-steps, or -1 when `most_substeps` was not enough or a number was not finite.
template <class Law>
long integrate_adaptive(const Law& law, const Pm4PointConstants& point, const Pm4AdaptiveOptions& options,
                        const Pm4State& committed, const PlaneStrain& strain, Pm4State& trial) {
  trial = committed;
  const double size = pm4_detail::length(strain);
  if (size == 0.0) return 0;
  pm4_detail::Update<Law> u{law,
                            point,
                            options,
                            strain,
                            size,
                            trial,
                            law.index0 + law.index_slope * committed.volumetric_strain,
                            law.index_slope * strain.volumetric};
  u.fraction = committed.substep_strain / size;
  Pm4Variables& v = trial.v;
  Pm4Surfaces surfaces = u.surfaces_at(v, 0.0);
  Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
  bool plastic = false;
  while (u.done < 1.0) {
    if (++u.substeps > options.most_substeps) return -1;
    const double f = yield_function(law.m, v.p, v.s, v.alpha);
    const bool on_surface = f >= -1e-7 * v.p;
    const Deviator n = cone_normal(v.p, v.s, v.alpha);
    const double n_r = contract(n, v.s) / v.p;
    const double outward =
        2.0 * moduli.G * contract(n, strain.deviator) - n_r * (moduli.K + moduli.G / 3.0) * strain.volumetric;
    const bool elastic = (!on_surface || outward < 0.0) && pm4_detail::elastic_substep(u, moduli, on_surface);
    if (!elastic) {
      u.note_reversal(n);
      pm4_detail::plastic_substep(u, pm4_detail::step_start(law, point, trial, v, surfaces, moduli, n));
      plastic = true;
      trial.z_peak = std::max(trial.z_peak, sqrt_half * norm(v.z));
    }
    surfaces = u.surfaces_at(v, u.done);
    clip_to_bounding_surface(law, point, surfaces.M_b, v);
    moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
    if (!std::isfinite(v.p + v.s.d + v.s.xy + v.alpha.d + v.alpha.xy + v.z.d + v.z.xy)) return -1;
  }
  if (plastic) trial.substep_strain = u.fraction * size;
  trial.volumetric_strain += strain.volumetric;
  trial.G = moduli.G;
  trial.K = moduli.K;
  return u.substeps;
}

}  // namespace tailrun::fem

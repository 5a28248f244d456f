// Integration by error alone: the sub-steps of a strain increment are as long as an embedded Runge-Kutta pair of order
// 3(2) allows, reversals, fabric records and the bounding-surface clip are followed sub-step by sub-step, so that the
// answer does not depend on how the caller cuts its steps. The moduli are evaluated at every stage.
#pragma once

#include "fem_stage/material/pm4_memory.hpp"
#include "fem_stage/material/pm4_rates.hpp"
#include "fem_stage/material/pm4_yield_cone.hpp"

namespace tailrun::fem {

struct Pm4AdaptiveOptions {
  double tolerance = 1e-4;      // relative error of stress (and of alpha and z/z_max) per sub-step
  double stress_scale = 0.005;  // of p_A: errors are relative to at least this stress
  double largest_growth = 4.0;  // of a sub-step over the one before
  double smallest = 1e-10;      // strain; a sub-step this short is accepted as it is
  double elastic_change = 0.1;  // largest relative change of p in one elastic sub-step
  long most_substeps = 200000;  // in one update; beyond it the update reports failure
};

namespace pm4_detail {

inline Pm4Variables plus(const Pm4Variables& v, double f, const Pm4Variables& change) {
  Pm4Variables out;
  out.p = v.p + f * change.p;
  out.s = v.s + f * change.s;
  out.alpha = v.alpha + f * change.alpha;
  out.z = v.z + f * change.z;
  out.z_cum = v.z_cum + f * change.z_cum;
  return out;
}

inline double length(const PlaneStrain& strain) {
  return std::sqrt(strain.volumetric * strain.volumetric + contract(strain.deviator, strain.deviator));
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
  Pm4Rates rates_at(const Pm4Variables& v, const Pm4Surfaces& surfaces) const {
    const Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
    const double z_peak = std::max(state.z_peak, sqrt_half * norm(v.z));
    return rates(law, point, state.memory, z_peak, v, surfaces, moduli, strain);
  }
  Pm4Rates rates_at(const Pm4Variables& v, double t) const { return rates_at(v, surfaces_at(v, t)); }
  void note_reversal(Deviator n) {
    if (reversed(state.memory, state.v.alpha, n)) {
      record_reversal(point, state.v.p, state.v.alpha, state.v.z, n, state.memory);
    }
  }
};

// An elastic sub-step from inside the cone, or from the cone into it: to the cone's far side, or as far as the modulus
// stays nearly the same. The modulus is the midpoint's, so the sub-step is of second order in the change of p.
template <class Law>
void elastic_substep(Update<Law>& u, const Pm4Moduli& moduli, bool on_surface) {
  Pm4Variables& v = u.state.v;
  double step = 1.0 - u.done;
  const double rate = std::fabs((moduli.K + moduli.G / 3.0) * u.strain.volumetric);
  const double most = u.options.elastic_change * std::max(v.p, u.point.p_min);
  if (rate * step > most) step = most / rate;
  Pm4Variables half = elastic_change(moduli, u.strain);
  half = plus(v, 0.5 * step, half);
  const double t_half = u.done + 0.5 * step;
  const Pm4Moduli midpoint =
      moduli_of(u.law, u.point, u.surfaces_at(half, t_half), std::max(half.p, 0.0), half.s, v.z_cum);
  const Pm4Variables change = elastic_change(midpoint, u.strain);
  const double exit = cone_exit(u.law.m, v.p, v.s, v.alpha, step * change.p, step * change.s, on_surface);
  const double taken = exit * step;
  v.p += taken * change.p;
  v.s = v.s + taken * change.s;
  u.done = exit < 1.0 || step < 1.0 - u.done ? u.done + taken : 1.0;
  if (hold_stress_floor(u.law, u.point, v)) return;
  u.note_reversal(cone_normal(v.p, v.s, v.alpha));
}

// A sub-step on the cone with error control.
template <class Law>
void plastic_substep(Update<Law>& u, const Pm4Rates& first) {
  const Pm4AdaptiveOptions& o = u.options;
  Pm4Variables& v = u.state.v;
  const double stress_scale = o.stress_scale * u.law.atmospheric_pressure;
  const double least = std::min(1.0, o.smallest / u.strain_length);
  for (;;) {
    const double rest = 1.0 - u.done;
    const bool last = u.fraction >= rest;
    const double h = last ? rest : u.fraction;
    const Pm4Variables at_half = plus(v, 0.5 * h, first.change);
    double error = 1e10;
    Pm4Variables next;
    if (at_half.p > 0.0) {
      const Pm4Variables k2 = u.rates_at(at_half, u.done + 0.5 * h).change;
      const Pm4Variables at_three_quarters = plus(v, 0.75 * h, k2);
      if (at_three_quarters.p > 0.0) {
        const Pm4Variables k3 = u.rates_at(at_three_quarters, u.done + 0.75 * h).change;
        next = plus(plus(plus(v, h * 2.0 / 9.0, first.change), h / 3.0, k2), h * 4.0 / 9.0, k3);
        // Difference from the midpoint rule, which the same stages contain.
        const Pm4Variables e =
            plus(plus(plus(Pm4Variables{}, h * 2.0 / 9.0, first.change), -h * 2.0 / 3.0, k2), h * 4.0 / 9.0, k3);
        const double size = std::max(std::sqrt(2.0 * next.p * next.p + contract(next.s, next.s)), stress_scale);
        const double stress_error = (2.0 * e.p * e.p + contract(e.s, e.s)) / (size * size);
        const double alpha_error = contract(e.alpha, e.alpha);
        const double z_error = contract(e.z, e.z) / (u.point.z_max * u.point.z_max);
        error = std::sqrt(std::max({stress_error, alpha_error, z_error}));
      }
    }
    const bool smallest = h <= least;
    double factor = std::min(0.85 * std::cbrt(o.tolerance / std::max(error, 1e-30)), o.largest_growth);
    if (!(error <= o.tolerance) && !smallest) {
      u.fraction = std::max(h * std::clamp(factor, 0.1, 0.9), least);
      continue;
    }
    if (!(error < 1e9)) {
      // The shortest sub-step still runs into tension: the state goes to the stress floor.
      next = v;
      next.p = 0.0;
    }
    v = next;
    u.done = last ? 1.0 : u.done + h;
    if (!(last && factor > 1.0)) u.fraction = h * std::max(factor, 0.2);
    u.fraction = std::max(u.fraction, least);
    return;
  }
}

}  // namespace pm4_detail

// The state at the end of the strain increment (compression positive) from the committed one. Returns the number of
// accepted sub-steps, or -1 when `most_substeps` was not enough or a number was not finite.
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
  u.fraction = std::min(1.0, committed.substep_strain / size);
  Pm4Variables& v = trial.v;
  Pm4Surfaces surfaces = u.surfaces_at(v, 0.0);
  bool plastic = false;
  while (u.done < 1.0) {
    if (++u.substeps > options.most_substeps) return -1;
    const double f = yield_function(law.m, v.p, v.s, v.alpha);
    const bool on_surface = f >= -1e-7 * v.p;
    const Deviator n = cone_normal(v.p, v.s, v.alpha);
    const Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
    const double n_r = contract(n, v.s) / v.p;
    const double outward =
        2.0 * moduli.G * contract(n, strain.deviator) - n_r * (moduli.K + moduli.G / 3.0) * strain.volumetric;
    if (!on_surface || outward < 0.0) {
      pm4_detail::elastic_substep(u, moduli, on_surface);
    } else {
      u.note_reversal(n);
      pm4_detail::plastic_substep(u, u.rates_at(v, surfaces));
      plastic = true;
      trial.z_peak = std::max(trial.z_peak, sqrt_half * norm(v.z));
      if (!hold_stress_floor(law, point, v)) recentre_cone(law, v);
    }
    surfaces = u.surfaces_at(v, u.done);
    clip_to_bounding_surface(law, point, surfaces.M_b, v);
    if (!std::isfinite(v.p + v.s.d + v.s.xy + v.alpha.d + v.alpha.xy + v.z.d + v.z.xy)) return -1;
  }
  if (plastic) trial.substep_strain = u.fraction * size;
  trial.volumetric_strain += strain.volumetric;
  const Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
  trial.G = moduli.G;
  trial.K = moduli.K;
  return u.substeps;
}

}  // namespace tailrun::fem

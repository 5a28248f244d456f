// Integration over a global step as OpenSees does it (its scheme 5), for comparison runs: memory updated once from the
// committed state, pieces of at most 1e-5 strain, each by Heun's pair with the moduli of the piece's start and with
// fabric records frozen; bounding-surface clip and fabric records at commit.
#pragma once

#include "fem_stage/material/pm4_drift.hpp"
#include "fem_stage/material/pm4_memory.hpp"

namespace tailrun::fem {

struct Pm4OpenSeesConstants {
  static constexpr double piece = 1e-5;          // largest strain component of a piece
  static constexpr double tolerance = 1e-5;      // relative stress error of a sub-step
  static constexpr double smallest = 1e-4;       // smallest fraction of a piece
  static constexpr double stress_scale = 0.005;  // of p_A: the error is relative to at least this stress
};

inline double stress_norm(double p, Deviator s) {
  return std::sqrt(2.0 * p * p + contract(s, s));
}

inline Pm4Variables advanced(const Pm4Variables& v, const Pm4Variables& change) {
  Pm4Variables out = v;
  out.p += change.p;
  out.s = v.s + change.s;
  out.alpha = v.alpha + change.alpha;
  out.z = v.z + change.z;
  return out;
}

// One piece: Heun's pair with error control. Returns the number of accepted sub-steps.
template <class Law>
long integrate_piece(const Law& law, const Pm4PointConstants& point, const PlaneStrain& strain, double density_index,
                     Pm4State& state) {
  using C = Pm4OpenSeesConstants;
  Pm4Variables& v = state.v;
  v.p = std::max(v.p, stress_floor_fraction * point.p_min);
  const Pm4Variables start = v;
  const Pm4Moduli moduli =
      moduli_of(law, point, law.surfaces(point, std::max(v.p, point.p_min), density_index), v.p, v.s, v.z_cum);
  double done = 0.0;
  double fraction = 1.0;
  long accepted = 0;
  while (done < 1.0) {
    const PlaneStrain sub{fraction * strain.volumetric, fraction * strain.deviator};
    const auto evaluate = [&](const Pm4Variables& at) {
      const Pm4Surfaces surfaces = law.surfaces(point, std::max(at.p, point.p_min), density_index);
      state.M_b = surfaces.M_b;
      return rates(law, point, state.memory, state.z_peak, at, surfaces, moduli, sub);
    };
    const auto give_up = [&] {  // the piece is left out
      v = start;
      return accepted;
    };
    const Pm4Variables first = evaluate(v).change;
    const Pm4Variables predicted = advanced(v, first);
    const bool smallest = fraction <= C::smallest;
    if (!(predicted.p > 0.0)) {
      if (smallest) return give_up();
      fraction = std::max(0.1 * fraction, C::smallest);
      continue;
    }
    const Pm4Rates end = evaluate(predicted);
    const Pm4Variables& second = end.change;
    Pm4Variables mean;
    mean.p = 0.5 * (first.p + second.p);
    mean.s = 0.5 * (first.s + second.s);
    mean.alpha = 0.5 * (first.alpha + second.alpha);
    mean.z = 0.5 * (first.z + second.z);
    Pm4Variables next = advanced(v, mean);
    if (!(next.p > 0.0)) {
      if (smallest) return give_up();
      fraction = std::max(0.1 * fraction, C::smallest);
      continue;
    }
    const double scale = std::max(stress_norm(next.p, next.s), C::stress_scale * law.atmospheric_pressure);
    const double error = stress_norm(second.p - first.p, second.s - first.s) / (2.0 * scale);
    const double factor = 0.8 * std::sqrt(C::tolerance / std::max(error, 1e-16));
    if (error > C::tolerance && !smallest) {
      fraction = std::max(std::max(factor, 0.1) * fraction, C::smallest);
      continue;
    }
    if (error > C::tolerance) next.z = v.z;  // OpenSees leaves the fabric alone in a sub-step accepted at the limit
    v = next;
    if (!hold_stress_floor(law, point, v)) {
      correct_drift(law, point, state.memory, state.z_peak, {density_index, end.L, moduli}, v, state.M_b);
    }
    ++accepted;
    done += fraction;
    fraction = std::min(std::max(std::max(factor, 0.5) * fraction, C::smallest), 1.0 - done);
    if (1.0 - done < 1e-12) break;
  }
  return accepted;
}

// The trial state at the end of a global step from the committed one. Returns the number of sub-steps.
template <class Law>
long integrate_opensees(const Law& law, const Pm4PointConstants& point, const Pm4State& committed,
                        const PlaneStrain& strain, Pm4State& trial) {
  trial = committed;
  Pm4Variables& v = trial.v;
  const Pm4Moduli moduli{committed.G, committed.K, 0.0};
  const Pm4Variables elastic = elastic_change(moduli, strain);
  const Pm4Variables elastic_trial = advanced(v, elastic);
  const Deviator n_trial = cone_normal(elastic_trial.p, elastic_trial.s, v.alpha);
  if (reversed(trial.memory, v.alpha, n_trial)) {
    record_reversal(point, v.p, v.alpha, v.z, n_trial, trial.memory);
  }
  const double tol = law.tolerance;
  trial.volumetric_strain += strain.volumetric;
  if (yield_function(law.m, elastic_trial.p, elastic_trial.s, v.alpha) <= tol) {
    v = elastic_trial;  // below the floor, too: the next plastic piece raises it
    return 1;
  }

  const double f = yield_function(law.m, v.p, v.s, v.alpha);
  double fraction = 0.0;
  if (f < -tol) {
    fraction = cone_exit(law.m, v.p, v.s, v.alpha, elastic.p, elastic.s, false);
  } else if (f <= tol) {
    const Deviator n = cone_normal(v.p, v.s, v.alpha);
    const double change = stress_norm(elastic.p, elastic.s);
    // OpenSees' test is on sqrt(tolerance) in kPa: 1e-4.
    if (contract(n, elastic.s) < -1e-4 * change) {
      fraction = cone_exit(law.m, v.p, v.s, v.alpha, elastic.p, elastic.s, true);
    }
  }
  v.p += fraction * elastic.p;
  v.s = v.s + fraction * elastic.s;

  const PlaneStrain rest{(1.0 - fraction) * strain.volumetric, (1.0 - fraction) * strain.deviator};
  const double largest =
      std::max({std::fabs(0.5 * rest.volumetric + rest.deviator.d), std::fabs(0.5 * rest.volumetric - rest.deviator.d),
                2.0 * std::fabs(rest.deviator.xy)});
  const long pieces = std::max(1L, static_cast<long>(std::ceil(largest / Pm4OpenSeesConstants::piece)));
  const double share = 1.0 / static_cast<double>(pieces);
  const PlaneStrain piece{share * rest.volumetric, share * rest.deviator};
  long substeps = 0;
  for (long i = 0; i < pieces; ++i) {
    const double strain_so_far =
        committed.volumetric_strain + fraction * strain.volumetric + static_cast<double>(i) * piece.volumetric;
    substeps += integrate_piece(law, point, piece, law.index0 + law.index_slope * strain_so_far, trial);
  }
  return substeps;
}

// What OpenSees does when a global step is accepted.
template <class Law>
void finish_step_opensees(const Law& law, const Pm4PointConstants& point, const Pm4State& committed, Pm4State& trial) {
  Pm4Variables& v = trial.v;
  const double index = law.index0 + law.index_slope * trial.volumetric_strain;
  v.z_cum += sqrt_half * norm(v.z - committed.v.z);
  trial.z_peak = std::max(trial.z_peak, sqrt_half * norm(v.z));
  Pm4Surfaces surfaces = law.surfaces(point, std::max(v.p, point.p_min), index);
  // OpenSees clips at the M_b that it evaluated last, which in an elastic step is an earlier step's.
  if (trial.M_b > 0.0) surfaces.M_b = trial.M_b;
  clip_to_bounding_surface(law, point, surfaces.M_b, v);
  const Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
  trial.set(surfaces, moduli);
}

}  // namespace tailrun::fem

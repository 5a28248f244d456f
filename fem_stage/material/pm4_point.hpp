// One material point of PM4Sand or PM4Silt through its life: elastic stage, initialisation from a stress, trial update,
// commit. Compression positive inside; pm4_points.hpp turns signs at the door.
#pragma once

#include <optional>

#include "fem_stage/material/pm4_adaptive.hpp"
#include "fem_stage/material/pm4_opensees.hpp"

namespace tailrun::fem {

// In-plane stress (compression positive, Pa) that the element sees: the model's own plus the constant offset.
struct PlaneStress {
  double p = 0.0;
  Deviator s;
};

inline PlaneStress total_stress(const Pm4PointConstants& point, const Pm4State& state) {
  return {state.v.p + point.offset_p, state.v.s + point.offset_s};
}

// Elastic stage (gravity): G = G_0 p_A whatever the stress, K from `poisson`.
template <class Law>
void elastic_stage_update(const Law& law, double poisson, const Pm4State& committed, const PlaneStrain& strain,
                          Pm4State& trial) {
  trial = committed;
  trial.G = law.G0_pA;
  trial.K = bulk_over_shear_of(poisson) * law.G0_pA;
  const Pm4Variables change = elastic_change({trial.G, trial.K, 0.0}, strain);
  trial.v.p += change.p;
  trial.v.s = trial.v.s + change.s;
  trial.volumetric_strain += strain.volumetric;
}

// Brings a stress at rest back to what `initialise` can take over without an offset: no tension, and at constant p no
// more than the larger of the bounding and the dilatancy ratio.
template <class Law>
void return_to_initial_strength(const Law& law, Pm4Variables& v) {
  if (v.p <= 0.0) {
    v.p = 0.0;
    v.s = {};
    return;
  }
  Pm4PointConstants point;
  set_initial_constants(law, v.p, v.p - v.s.d, true, point);
  const Pm4Surfaces surfaces = law.surfaces(point, std::max(v.p, point.p_min), law.index0);
  const double most = sqrt_half * std::max(surfaces.M_b, surfaces.M_d) * v.p, size = norm(v.s);
  if (size > most) v.s = (most / size) * v.s;
}

// Starts the plastic stage from a stress (pm4 manuals, "FirstCall"): memory and fabric are erased, the void ratio is
// the input one, and whatever the model cannot carry (tension, q/p above both surfaces) becomes a constant offset. A_do
// and z_max are worked out again when `recompute` is set or when they never were.
template <class Law>
void initialise(const Law& law, const PlaneStress& stress, bool recompute, Pm4PointConstants& point, Pm4State& state) {
  state = Pm4State{};
  Pm4Variables& v = state.v;
  double p0 = stress.p;
  const double vertical = stress.p - stress.s.d;
  set_initial_constants(law, p0, vertical, recompute || point.initialised == 0.0, point);
  point.initialised = 1.0;
  point.offset_p = 0.0;
  point.offset_s = {};
  if (p0 < point.p_min) {
    v.p = p0 = point.p_min;
    v.s = {};
    v.alpha = {};
  } else {
    v.p = p0;
    v.s = stress.s;
    v.alpha = (1.0 / p0) * stress.s;
  }
  const Pm4Surfaces surfaces = law.surfaces(point, std::max(p0, point.p_min), law.index0);
  const double M_cut = std::max(surfaces.M_b, surfaces.M_d);
  const double M_cur = sqrt_two * norm(v.s) / p0;
  if (M_cur > M_cut) {
    v.s = (M_cut / M_cur) * v.s;
    v.alpha = ((M_cut - law.m) / (M_cut * p0)) * v.s;
  }
  point.offset_p = stress.p - v.p;
  point.offset_s = stress.s - v.s;

  Pm4Memory& memory = state.memory;
  memory.alpha_in_true = v.alpha;
  memory.alpha_in_max = memory.alpha_in_min = components(v.alpha);
  memory.alpha_in = components(Law::apparent_ratio_starts_at_alpha ? v.alpha : Deviator{});
  memory.p_zp = std::max(p0, point.p_min) / 100.0;
  state.z_peak = 1e-5 * point.z_max;
  const Pm4Moduli moduli = moduli_of(law, point, surfaces, v.p, v.s, v.z_cum);
  state.set(surfaces, moduli);
}

// Trial states for strain increments (not zero) since the last commit. Where sub-steps become -1, the increment could
// not be integrated and the trial state is the committed one.
template <class Law>
void trial_updates(const Law& law, const Pm4AdaptiveOptions& options, std::span<Pm4Update> updates) {
  if (law.compatibility == Pm4Compatibility::opensees) {
    for (Pm4Update& u : updates) u.substeps = integrate_opensees(law, *u.point, *u.committed, u.strain, *u.trial);
    return;
  }
  integrate_adaptive(law, options, updates);
  for (Pm4Update& u : updates) {
    if (u.substeps < 0) *u.trial = *u.committed;
  }
}

// One point's. Returns the sub-steps.
template <class Law>
long trial_update(const Law& law, const Pm4PointConstants& point, const Pm4AdaptiveOptions& options,
                  const Pm4State& committed, const PlaneStrain& strain, Pm4State& trial) {
  trial = committed;
  if (strain.volumetric == 0.0 && strain.deviator.d == 0.0 && strain.deviator.xy == 0.0) return 0;
  Pm4Update update{&point, &committed, strain, &trial, 0};
  trial_updates(law, options, std::span(&update, 1));
  return update.substeps;
}

// What is left to do when the trial state is accepted.
template <class Law>
void commit_update(const Law& law, const Pm4PointConstants& point, Pm4State& committed, Pm4State& trial) {
  if (law.compatibility == Pm4Compatibility::opensees) finish_step_opensees(law, point, committed, trial);
  committed = trial;
}

}  // namespace tailrun::fem

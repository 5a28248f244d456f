// One point on its way through a strain increment: how far it has come, and its elastic sub-steps.
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

// One update: from the committed state over a strain increment (compression positive) to the trial state.
struct Pm4Update {
  const Pm4PointConstants* point = nullptr;
  const Pm4State* committed = nullptr;
  PlaneStrain strain;
  Pm4State* trial = nullptr;
  long substeps = 0;  // result; -1 when `most_substeps` was not enough or a number was not finite
};

namespace pm4_detail {

template <class Law>
class Progress {
 public:
  Pm4Update* update = nullptr;
  double size = 0.0;  // norm of the whole increment
  double index_start = 0.0;
  double index_rate = 0.0;
  double done = 0.0;
  double fraction = 1.0;  // next sub-step to try
  long substeps = 0;
  bool any_plastic = false;
  // The rejected trial before this one; 0 if there is none.
  double h_before = 0.0;
  double error_before = 0.0;

  void start(const Law& law, Pm4Update& job) {
    update = &job;
    copy(*job.committed, *job.trial);
    const PlaneStrain& e = job.strain;
    size = std::sqrt(e.volumetric * e.volumetric + contract(e.deviator, e.deviator));
    index_start = law.index0 + law.index_slope * job.committed->volumetric_strain;
    index_rate = law.index_slope * e.volumetric;
    done = 0.0;
    fraction = job.committed->substep_strain / size;
    substeps = 0;
    any_plastic = false;
    h_before = 0.0;
  }

  // Goes through elastic sub-steps until a plastic one is next (true) or the update is at its end (false).
  bool reach_plastic(const Law& law, const Pm4AdaptiveOptions& options) {
    Pm4State& state = *update->trial;
    Pm4Variables& v = state.v;
    const PlaneStrain& strain = update->strain;
    while (done < 1.0) {
      if (++substeps > options.most_substeps) return fail();
      // The normal is radius/|radius|, but only signs matter here.
      const Deviator radius = v.s - v.p * v.alpha;
      const bool on_surface = contract(radius, radius) >= square((sqrt_half * law.m - 1e-7) * v.p);
      const double outward = 2.0 * state.G * contract(radius, strain.deviator) * v.p -
                             contract(radius, v.s) * (state.K + state.G / 3.0) * strain.volumetric;
      const bool elastic = (!on_surface || outward < 0.0) && elastic_substep(law, options, on_surface);
      if (!elastic) {
        note_reversal(radius);
        any_plastic = true;
        return true;
      }
      set_surfaces(law, law.surfaces(*update->point, std::max(v.p, update->point->p_min), index_at(done)));
      if (!finite()) return fail();
    }
    if (any_plastic) state.substep_strain = fraction * size;
    state.volumetric_strain += strain.volumetric;
    update->substeps = substeps;
    return false;
  }
  // Ends a sub-step: the state on its bounding surface at most, and the moduli there.
  void set_surfaces(const Law& law, const Pm4Surfaces& surfaces) {
    Pm4State& state = *update->trial;
    Pm4Variables& v = state.v;
    clip_to_bounding_surface(law, *update->point, surfaces.M_b, v);
    state.set(surfaces, moduli_of(law, *update->point, surfaces, v.p, v.s, v.z_cum));
  }
  bool finite() const {
    const Pm4Variables& v = update->trial->v;
    return std::isfinite(v.p + v.s.d + v.s.xy + v.alpha.d + v.alpha.xy + v.z.d + v.z.xy);
  }
  bool fail() {
    update->substeps = -1;
    return false;
  }
  double index_at(double t) const { return index_start + index_rate * t; }

 private:
  // libc's memcpy costs more than these few vectors.
  static void copy(const Pm4State& from, Pm4State& to) {
    to.v = from.v;
    to.memory = from.memory;
    to.z_peak = from.z_peak;
    to.volumetric_strain = from.volumetric_strain;
    to.M_b = from.M_b;
    to.substep_strain = from.substep_strain;
    to.set(from.surfaces, from.moduli());
  }
  void note_reversal(Deviator normal) {
    Pm4State& state = *update->trial;
    if (reversed(state.memory, state.v.alpha, normal)) {
      record_reversal(*update->point, state.v.p, state.v.alpha, state.v.z, normal, state.memory);
    }
  }

  // An elastic sub-step from inside the cone, or from the cone into it: to the cone's far side, or as far as the
  // modulus stays nearly the same. The modulus is the midpoint's, so the sub-step is of second order in the change of
  // p. Returns false, and does nothing, when with that modulus the path leaves the cone at once.
  bool elastic_substep(const Law& law, const Pm4AdaptiveOptions& options, bool on_surface) {
    const Pm4PointConstants& point = *update->point;
    const PlaneStrain& strain = update->strain;
    Pm4Variables& v = update->trial->v;
    const double rest = 1.0 - done;
    const double floor = stress_floor_fraction * point.p_min;
    const Pm4Moduli moduli = update->trial->moduli();
    const double rate = (moduli.K + moduli.G / 3.0) * strain.volumetric;
    const double most = options.elastic_change * std::max(v.p, point.p_min);
    const bool at_floor = v.p <= floor && rate < 0.0;
    double step = rest;
    if (!at_floor && std::fabs(rate) * step > most) step = most / std::fabs(rate);
    Pm4Variables change = elastic_change(moduli, strain);
    if (std::fabs(rate) * step > 0.01 * v.p && !at_floor) {
      const double p_half = std::max(v.p + 0.5 * step * change.p, floor);
      const Deviator s_half = v.s + 0.5 * step * change.s;
      const Pm4Surfaces half = law.surfaces(point, std::max(p_half, point.p_min), index_at(done + 0.5 * step));
      change = elastic_change(moduli_of(law, point, half, p_half, s_half, v.z_cum), strain);
    }
    if (at_floor) change.p = 0.0;
    const double exit = cone_exit(law.m, v.p, v.s, v.alpha, step * change.p, step * change.s, on_surface);
    if (exit == 0.0) return false;
    const double taken = exit * step;
    v.p = std::max(v.p + taken * change.p, floor);
    v.s = v.s + taken * change.s;
    done = exit < 1.0 || step < rest ? done + taken : 1.0;
    note_reversal(cone_normal(v.p, v.s, v.alpha));
    return true;
  }
};

}  // namespace pm4_detail
}  // namespace tailrun::fem

// Integration by error alone. Two things make the rate equations stiff once soil flows: the cone is so thin that its
// normal n turns to the strain direction within a strain of m p/G, and at the bounding surface the plastic modulus
// ~ sqrt(B) has an infinite slope. Explicit schemes then need thousands of sub-steps. Here every sub-step is a
// semi-implicit Euler step (pm4_implicit_step.hpp); one whole and two half steps give the error and, extrapolated,
// second order (Deuflhard 1985). Reversals, fabric records and the bounding-surface clip are followed sub-step by
// sub-step, so that the answer does not depend on the caller's steps.
//
// Plastic sub-steps are taken four points at a time (lanes.hpp): each lane works through its own point's sub-steps, and
// takes on the next point when it is done. No number of a point depends on which others were with it.
#pragma once

#include <array>
#include <span>

#include "fem_stage/material/pm4_implicit_step.hpp"
#include "fem_stage/material/pm4_progress.hpp"

namespace tailrun::fem {

namespace pm4_detail {

// A trial of one sub-step in each lane.
struct SubstepTrial {
  Pm4VariablesOf<Lanes> v;  // the extrapolated end
  Pm4SurfacesOf<Lanes> surfaces;
  Pm4ModuliOf<Lanes> moduli;
  LaneMask outside;  // of the bounding surface
  Lanes z_peak;
  Lanes error;  // of the un-extrapolated end
};

template <class Law>
[[gnu::flatten]] SubstepTrial try_substep(const Law& law, const Pm4AdaptiveOptions& o,
                                          const std::array<Progress<Law>*, lane_count>& in,
                                          const std::array<double, lane_count>& h) {
  const auto& [a, b, c, d] = in;
  const auto point = gather(*a->update->point, *b->update->point, *c->update->point, *d->update->point);
  const auto state = gather(*a->update->trial, *b->update->trial, *c->update->trial, *d->update->trial);
  const auto strain = gather(a->update->strain, b->update->strain, c->update->strain, d->update->strain);
  const auto of_lane = [](auto&& value) { return Lanes(Lanes::Vector{value(0), value(1), value(2), value(3)}); };
  const Lanes share = of_lane([&](std::size_t k) { return h[k]; });
  const Lanes index_half = of_lane([&](std::size_t k) { return in[k]->index_at(in[k]->done + 0.5 * h[k]); });
  const Lanes index_end = of_lane([&](std::size_t k) { return in[k]->index_at(in[k]->done + h[k]); });

  const Pm4VariablesOf<Lanes>& v = state.v;
  const DeviatorOf<Lanes> radius = v.s - v.p * v.alpha;
  const DeviatorOf<Lanes> n = (1.0 / number::max(norm(radius), Lanes(1e-300))) * radius;
  const PlaneStrainOf<Lanes> whole{share * strain.volumetric, share * strain.deviator};
  const PlaneStrainOf<Lanes> half{0.5 * whole.volumetric, 0.5 * whole.deviator};
  const StepStart start = step_start(law, {point, state.memory, state.z_peak, v, state.surfaces, state.moduli(), n});
  const ImplicitStep one = implicit_euler(law, point, v, start, whole);
  const ImplicitStep first = implicit_euler(law, point, v, start, half);
  const Pm4SurfacesOf<Lanes> surfaces_half = law.surfaces(point, number::max(first.v.p, point.p_min), index_half);
  const Pm4ModuliOf<Lanes> moduli_half = moduli_of(law, point, surfaces_half, first.v.p, first.v.s, first.v.z_cum);
  const Lanes z_peak_half = number::max(state.z_peak, sqrt_half * norm(first.v.z));
  const StepStart middle =
      step_start(law, {point, state.memory, z_peak_half, first.v, surfaces_half, moduli_half, first.n});
  const ImplicitStep second = implicit_euler(law, point, first.v, middle, half);

  SubstepTrial out;
  const Lanes dp = second.v.p - one.v.p;
  const DeviatorOf<Lanes> ds = second.v.s - one.v.s;
  const DeviatorOf<Lanes> dz = second.v.z - one.v.z;
  const Lanes size_squared = number::max(2.0 * second.v.p * second.v.p + contract(second.v.s, second.v.s),
                                         Lanes(square(o.stress_scale * law.atmospheric_pressure)));
  out.error = number::sqrt(
      number::max((2.0 * dp * dp + contract(ds, ds)) / size_squared, contract(dz, dz) / square(point.z_max)));
  const LaneMask extrapolate = one.plastic & first.plastic & second.plastic;
  const Lanes floor = stress_floor_fraction * point.p_min;
  out.v.p = select(extrapolate, number::max(second.v.p + dp, floor), second.v.p);
  out.v.s = select(extrapolate, second.v.s + ds, second.v.s);
  out.v.z = select(extrapolate, second.v.z + dz, second.v.z);
  out.v.z_cum = select(extrapolate, number::max(2.0 * second.v.z_cum - one.v.z_cum, first.v.z_cum), second.v.z_cum);
  const DeviatorOf<Lanes> normal = 2.0 * second.n - one.n;
  out.v.alpha =
      select(extrapolate, (1.0 / out.v.p) * out.v.s - (sqrt_half * law.m / norm(normal)) * normal, second.v.alpha);
  out.z_peak = number::max(state.z_peak, sqrt_half * norm(out.v.z));
  out.surfaces = law.surfaces(point, number::max(out.v.p, point.p_min), index_end);
  out.moduli = moduli_of(law, point, out.surfaces, out.v.p, out.v.s, out.v.z_cum);
  out.outside = sqrt_two * norm(out.v.s) > out.surfaces.M_b * out.v.p;
  return out;
}

// Accepts or rejects a lane's trial, and plans the next sub-step. Returns whether the point needs more.
template <class Law>
bool finish_substep(const Law& law, const Pm4AdaptiveOptions& o, const SubstepTrial& trial, std::size_t lane, double h,
                    Progress<Law>& u) {
  const double error = trial.error[lane];
  const double rest = 1.0 - u.done;
  const bool last = u.fraction >= rest;
  const double least = std::min(1.0, o.smallest / u.size);
  // An increment far outside what the error control was made for must end, too.
  const double tolerance =
      std::min(0.1, o.tolerance * std::max(1.0, square(static_cast<double>(u.substeps) / o.full_accuracy)));
  const double factor = std::min(0.9 * std::sqrt(tolerance / std::max(error, 1e-30)), o.largest_growth);
  // Dilatancy jumps where contraction turns into dilation below 2 p_min; a state that slides along the jump has an
  // error proportional to h (not h^2) that does not accumulate.
  const bool jump =
      u.h_before > 0.0 && error <= o.discontinuity * tolerance &&
      error * u.h_before * std::sqrt(std::sqrt(u.h_before)) > u.error_before * h * std::sqrt(std::sqrt(h));
  if (!(error <= tolerance) && !jump && h > least) {
    u.fraction = std::max(h * std::clamp(factor, 0.1, 0.5), least);
    u.h_before = h;
    u.error_before = error;
    return ++u.substeps <= o.most_substeps || u.fail();
  }
  Pm4State& state = *u.update->trial;
  take_lane(trial.v, lane, state.v);
  state.z_peak = trial.z_peak[lane];
  Pm4Surfaces surfaces;
  take_lane(trial.surfaces, lane, surfaces);
  // Lanes that the bounding surface does not touch have their moduli.
  if (trial.outside[lane]) {
    u.set_surfaces(law, surfaces);
  } else {
    Pm4Moduli moduli;
    take_lane(trial.moduli, lane, moduli);
    state.set(surfaces, moduli);
  }
  u.h_before = 0.0;
  u.done = last ? 1.0 : u.done + h;
  // A last sub-step cut short by the end of the increment says nothing against the longer one planned before.
  const double next = h * (jump ? 1.0 : std::max(factor, 0.2));
  u.fraction = std::max({next, least, last && factor > 1.0 ? u.fraction : 0.0});
  if (!u.finite()) return u.fail();
  return u.reach_plastic(law, o);
}

}  // namespace pm4_detail

// All updates, of points of one material. No strain increment may be zero.
template <class Law>
void integrate_adaptive(const Law& law, const Pm4AdaptiveOptions& options, std::span<Pm4Update> updates) {
  using pm4_detail::Progress;
  std::array<Progress<Law>, lane_count> lanes;
  std::size_t next = 0;
  // Gives a lane the next point whose update has a plastic sub-step.
  const auto take_on = [&](Progress<Law>& lane) {
    while (next < updates.size()) {
      lane.start(law, updates[next++]);
      if (lane.reach_plastic(law, options)) return true;
    }
    lane.update = nullptr;
    return false;
  };
  std::size_t busy = 0;
  while (busy < lane_count && take_on(lanes[busy])) ++busy;
  while (busy > 0) {
    std::array<Progress<Law>*, lane_count> in;
    std::array<double, lane_count> h;
    // Idle lanes repeat the first.
    for (std::size_t k = 0; k < lane_count; ++k) {
      in[k] = &lanes[k < busy ? k : 0];
      h[k] = std::min(in[k]->fraction, 1.0 - in[k]->done);
    }
    const pm4_detail::SubstepTrial trial = pm4_detail::try_substep(law, options, in, h);
    for (std::size_t k = busy; k-- > 0;) {
      if (finish_substep(law, options, trial, k, h[k], lanes[k]) || take_on(lanes[k])) continue;
      if (k != --busy) lanes[k] = lanes[busy];
    }
  }
}

}  // namespace tailrun::fem

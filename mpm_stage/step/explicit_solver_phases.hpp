// The phases of the explicit step, in the order in which explicit_solver.hpp runs them; included there.
//
// Blocks hold very different numbers of particles, so threads take them a few at a time; what a block computes does not
// depend on who computes it.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::update_grid(double dt, const std::array<double, Dim>& body,
                                                              const std::array<double, Dim>& inertial) {
  const auto since = Clock::now();
  bool shaken = false;
  for (const double a : inertial) shaken = shaken || a != 0.0;
  // Nodes at mirrors need their images' sums, so those are complete before any velocity is made.
  const bool whole = needs_all_sums();
  const bool untouched = !shaken && !wall_nodes_.any_frictional() && !(options_.local_damping > 0.0);
  Vec4 acceleration = {};
  for (int d = 0; d < Dim; ++d) acceleration[d] = body[d];
  if (whole) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a)
      gather_sums<Dim, Shape, Split>(grid_, a, tiles_.data(), beside_.data(), sums_.data() + a * block_nodes,
                                     Split ? force_sums_.data() + a * block_nodes : nullptr);
    mirrors_.fold(sums_.data());
    if constexpr (Split) mirrors_.fold(force_sums_.data());
    if (extension_.active()) {
      extension_.choose(sums_.data());
      extension_.fold_momentum(sums_.data());
      if constexpr (Split) extension_.fold_force(sums_.data(), force_sums_.data());
    }
  }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    if (still(a)) {
      std::fill_n(velocity_.data() + a * block_nodes, block_nodes, Vec4{});
      grid_sums_[a] = {};
      if (options_.local_damping > 0.0)
        std::fill_n(damped_.data() + a * block_nodes, block_nodes, std::array<double, Dim>{});
      if (ground_.of_block(a)) std::fill_n(grip_.data() + a * block_nodes, block_nodes, NodeGrip{});
      continue;
    }
    Vec4 own_sum[block_nodes], own_force[Split ? block_nodes : 1];
    const Vec4 *sum = own_sum, *force = own_force;
    if (whole) {
      sum = sums_.data() + a * block_nodes;
      force = Split ? force_sums_.data() + a * block_nodes : nullptr;
    } else {
      gather_sums<Dim, Shape, Split>(grid_, a, tiles_.data(), beside_.data(), own_sum, own_force);
    }
    const NodeContact* contact = ground_.of_block(a);
    if (!contact && untouched) {
      grid_sums_[a] =
          move_free_nodes<Dim, Split>(dt, acceleration, mass_cutoff_, sum, force, velocity_.data() + a * block_nodes,
                                      separate_change ? change_.data() + a * block_nodes : nullptr);
      continue;
    }
    if (options_.local_damping > 0.0)
      std::fill_n(damped_.data() + a * block_nodes, block_nodes, std::array<double, Dim>{});
    GridSums<Dim> sums;
    Gap gap[block_nodes];
    if (contact) {
      gather_tiles<Dim, Shape>(grid_, a, gap_tiles_.data(), gap);
      std::fill_n(grip_.data() + a * block_nodes, block_nodes, NodeGrip{});
    }
    for (int n = 0; n < block_nodes; ++n) {
      const double m = sum[n][0];
      Vec4& out = velocity_[a * block_nodes + n];
      if (m <= mass_cutoff_) {
        out = Vec4{};
        if constexpr (separate_change) change_[a * block_nodes + n] = Vec4{};
        if (contact) smoothed_grip_[a * block_nodes + n] = 0.0;
        continue;
      }
      std::array<double, Dim> v, before{};
      for (int d = 0; d < Dim; ++d) {
        v[d] = sum[n][1 + d] / m;
        if constexpr (Split) {
          before[d] = v[d];
          v[d] += dt * force[n][1 + d] / m;
        }
        v[d] += dt * (body[d] + inertial[d]);
      }
      if constexpr (Split) {
        sums.kinetic_before += 0.5 * m * square<Dim>(before);
        if (options_.local_damping > 0.0)
          damped_[a * block_nodes + n] = apply_local_damping<Dim>(options_.local_damping, m, before, v);
      }
      const std::array<double, Dim> pushed = v;
      if (contact && contact[n].count > 0) {
        NodeGrip& grip = grip_[a * block_nodes + n];
        grip = stop_approach<Dim>(contact[n], m, std::max(0.0, gap[n].value) / dt, v);
        const double share = smoothing_share(dt * h1_ * fastest_wave_, dt * h1_ * sliding_speed<Dim>(contact[n], v));
        smooth_grip(contact[n], m, dt, share, smoothed_grip_[a * block_nodes + n], grip);
        grip.carried = grip.capacity;
        if (options_.soil_limits_friction)
          grip.carried = carried_by_soil(
              gap[n], ground_.surfaces(a)[n] * share_inside<Dim>(wall_nodes_, grid_.node_index(a, n)), dt);
      }
      const double rubbed = sums.friction;
      if (wall_nodes_.any) apply_walls<Dim>(wall_nodes_, grid_.node_index(a, n), m, v, sums);
      for (int d = 0; d < Dim; ++d) sums.impulse[d] += m * (v[d] - pushed[d]);
      if (shaken)
        for (int d = 0; d < Dim; ++d) sums.external += dt * m * inertial[d] * v[d];
      out = node_velocity<Dim>(v.data());
      if constexpr (Split) {
        sums.kinetic_after += 0.5 * m * square<Dim>(v);
        for (int d = 0; d < Dim; ++d) {
          sums.impact -= 0.5 * m * (v[d] - pushed[d]) * (before[d] + v[d]);
          before[d] = v[d] - before[d];
        }
        sums.impact -= sums.friction - rubbed;
        if constexpr (separate_change) change_[a * block_nodes + n] = Vec4{};
        add_change(a * block_nodes + n, before);
      }
    }
    grid_sums_[a] = sums;
  }
  if (ground_.any()) rub_ground(dt, inertial);
  if (!bodies_.empty()) move_bodies(dt);
  const auto reflect = [this] {
    mirrors_.reflect(velocity_.data());
    if constexpr (separate_change) mirrors_.reflect(change_.data());
  };
  if (mirrors_.any()) reflect();
  if (extension_.active()) {
    extension_.extend(velocity_.data());
    if constexpr (separate_change) extension_.extend(change_.data());
    if (mirrors_.any()) reflect();
  }
  if constexpr (Split) {
    if (whole) sum_kinetic_after();
    if (options_.local_damping > 0.0) book_damping();
  }
  nodes_gain_ = 0.0;
  for (const auto& s : grid_sums_) {
    work_.friction += s.friction;
    work_.damping += s.damping;
    work_.external += s.external;
    if constexpr (Split) work_.impact += s.impact;
    nodes_gain_ += s.kinetic_after - s.kinetic_before;
    for (int d = 0; d < Dim; ++d) impulse_[d] += s.impulse[d];
  }
  add_time(seconds_.grid, since);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::gather(double dt, StepReport& report) {
  const auto since = Clock::now();
  constexpr bool Flip = Transfer == TransferName::flip || Transfer == TransferName::aflip;
  constexpr bool Affine = Transfer == TransferName::apic || Transfer == TransferName::aflip;
  // Particles that start without affine velocities, whatever their velocities, take them from the grid as they are.
  const GridToParticles s{dt, h1_, flip_share(dt), time_ > 0.0 || starts_with_spin_ ? flip_share(dt) : 0.0};
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    Vec4 tile[tile_nodes], change[Flip && separate_change ? tile_nodes : 1];
    if constexpr (Dim == 2 && !Flip)
      load_tile<Dim, Shape>(grid_, b, velocity_.data(), tile, [](Vec4 v) { return twice(v); });
    else
      load_tile<Dim, Shape>(grid_, b, velocity_.data(), tile);
    if (averaging_) will_write(averaged_tiles_.data() + b * tile_nodes, tile_nodes);
    BlockMotion motion;
    if (sleep_.asleep(b) && sleeps_on(b, tile, dt)) {
      motion_[b] = BlockMotion{.wave = wave_speed_in(b), .asleep = true};
      if (averaging_ && sleep_.stale(b)) scatter_average(b);
      continue;
    }
    if constexpr (Flip && separate_change) load_tile<Dim, Shape>(grid_, b, change_.data(), change);
    for (const Run& run : grid_.runs(b)) {
      const MotionExtremes e =
          mpm::grid_to_particles<Shape, Flip, Affine>(s, tile, change, corner(b), P_, run.begin, run.end);
      motion.far = std::max(motion.far, e.displacement);
      motion.fast = std::max(motion.fast, e.speed_squared);
      motion.wave = std::max(motion.wave, wave_speed_[run.material] + std::sqrt(e.speed_squared));
      motion.kinetic += e.kinetic;
    }
    if (walls_.bounded) mind_sides(b, motion);
    if (sleep_.active() && sleep_.fall_asleep(b, motion.fast, dt)) lay_to_rest(b, motion);
    motion_[b] = motion;
    // The block's particles are still near the core. Should it be time to sort, this is done again after it.
    if (averaging_ && std::isfinite(motion.kinetic) && drift_ + motion.far * h1_ <= largest_drift) scatter_average(b);
  }
  double far = 0.0, fast = 0.0, gathered = 0.0;
  fastest_wave_ = 0.0;
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    const BlockMotion& m = motion_[b];
    // Maxima pass over a NaN; the kinetic energy does not.
    if (!std::isfinite(m.kinetic))
      fail(grid_.first_particle(b), grid_.last_particle(b), "has a velocity that is not finite");
    if (m.far > 0.99 * h_)
      fail(grid_.first_particle(b), grid_.last_particle(b),
           "moved more than a cell in one step: the time step is too long");
    far = std::max(far, m.far);
    fast = std::max(fast, m.fast);
    fastest_wave_ = std::max(fastest_wave_, m.wave);
    report.kinetic_energy += m.kinetic;
    gathered += m.kinetic + m.stopped;
    leaving_ = leaving_ || m.outside;
    work_.removed += m.stopped;
    if (m.asleep) report.asleep += grid_.last_particle(b) - grid_.first_particle(b);
  }
  report.maximum_speed = std::sqrt(fast);
  // Lost on the way to the nodes and on the way back.
  if constexpr (Split) work_.transfer += kinetic_ - gathered + nodes_gain_;
  kinetic_ = report.kinetic_energy;
  drift_ += far * h1_;
  add_time(seconds_.grid_to_particles, since);
}

// Particles beyond a side of the domain: held there, or noticed, so that the sort deals with them.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::mind_sides(std::size_t b, BlockMotion& motion) {
  // Only blocks at the domain's edge can lose particles.
  bool edge = false;
  for (int d = 0; d < Dim; ++d) {
    const double low = corner(b)[d], high = low + Tile<Dim, Shape>::side * h_;
    edge = edge || low < walls_.low[d] || high > walls_.high[d];
  }
  if (!edge) return;
  for (std::size_t p = grid_.first_particle(b); p < grid_.last_particle(b); ++p)
    for (int d = 0; d < Dim; ++d) {
      double &x = P_.position[d][p], &v = P_.velocity[d][p];
      const bool under = x<walls_.low[d], over = x> walls_.high[d];
      if (!under && !over) continue;
      if (walls_.leaving != LeavingParticles::wall) {
        motion.outside = true;
        continue;
      }
      x = under ? walls_.low[d] : walls_.high[d];
      held_[static_cast<std::size_t>(P_.identity[p])] = 1;
      if (under ? v < 0.0 : v > 0.0) {
        motion.stopped += 0.5 * P_.mass[p] * v * v;
        motion.kinetic -= 0.5 * P_.mass[p] * v * v;
        v = 0.0;
      }
    }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_average(std::size_t b) {
  PatchSum* tile = averaged_tiles_.data() + b * tile_nodes;
  std::fill(tile, tile + tile_nodes, PatchSum{});
  for (const Run& run : grid_.runs(b))
    if (constants_[run.material].averaged)
      scatter_volumetric<Dim, Shape>(constants_[run.material], P_, run.begin, run.end, corner(b), h1_, tile);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::average(bool sorted) {
  const auto since = Clock::now();
  if (sorted) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t b = 0; b < grid_.occupied(); ++b) scatter_average(b);
  }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    PatchSum sum[block_nodes];
    gather_tiles<Dim, Shape>(grid_, a, averaged_tiles_.data(), sum);
    fit_patches<Dim>(sum, averaged_.data() + a * block_nodes);
  }
  add_time(seconds_.volumetric, since);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::update_stresses(double dt) {
  const auto since = Clock::now();
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    if (sleep_.asleep(b)) {
      stress_work_[b] = {};
      if (!sleep_.stale(b)) continue;
      sleep_.put_on_nodes(b);
      scatter_block(b);
      continue;
    }
    will_write(tiles_.data() + b * tile_nodes, tile_nodes);
    stress_work_[b] = update_stresses_of(b, dt);
    if (std::isfinite(stress_work_[b].dissipated)) scatter_block(b);
  }
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    if (!std::isfinite(stress_work_[b].dissipated))
      fail(grid_.first_particle(b), grid_.last_particle(b),
           "is inverted: its volume changes beyond all measure in one step");
    work_.plastic += stress_work_[b].dissipated;
    work_.pore_pressure += stress_work_[b].pore_pressure;
  }
  add_time(seconds_.stress_and_scatter, since);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
StressWork ExplicitSolver<Dim, Shape, Split, Transfer>::update_stresses_of(std::size_t b, double dt) {
  PatchFit fit[tile_nodes];
  bool loaded = false;
  StressWork work;
  double trace[few_particles];
  for (const Run& run : grid_.runs(b)) {
    const MaterialConstants& k = constants_[run.material];
    if (k.averaged && !loaded) {
      load_tile<Dim, Shape>(grid_, b, averaged_.data(), fit);
      loaded = true;
    }
    for (std::size_t begin = run.begin; begin < run.end; begin += few_particles) {
      const std::size_t end = std::min(run.end, begin + few_particles);
      if (k.averaged) {
        gather_volumetric<Dim, Shape>(k, P_, begin, end, corner(b), h1_, fit, trace);
      } else {
        own_volumetric(P_, begin, end, trace);
      }
      if (inverts(trace, end - begin)) return {std::nan(""), 0.0};
      const StressWork done = update_stress(k, P_, begin, end, trace, dt);
      work.dissipated += done.dissipated;
      work.pore_pressure += done.pore_pressure;
    }
  }
  return work;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::particles_to_grid() {
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b) scatter_block(b);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_block(std::size_t b) {
  Vec4* tile = tiles_.data() + b * tile_nodes;
  SplitNode<Dim>* beside = Split ? beside_.data() + b * tile_nodes : nullptr;
  std::fill(tile, tile + tile_nodes, Vec4{});
  if constexpr (Split) std::fill(beside, beside + tile_nodes, SplitNode<Dim>{});
  const std::size_t begin = grid_.first_particle(b), end = grid_.last_particle(b);
  if (P_.pore_pressure.empty())
    mpm::particles_to_grid<Shape, Split, false>(next_dt_, h1_, corner(b), P_, begin, end, tile, beside);
  else
    mpm::particles_to_grid<Shape, Split, true>(next_dt_, h1_, corner(b), P_, begin, end, tile, beside);
  if (ground_.any()) scatter_ground_gaps(b);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_ground_gaps(std::size_t b) {
  Gap* gap = gap_tiles_.data() + b * tile_nodes;
  std::fill(gap, gap + tile_nodes, Gap{});
  if (!ground_.near_ground(b)) return;
  double distance[tile_nodes];
  load_tile_if<Dim, Shape>(
      grid_, b, [this](std::size_t a) { return ground_.of_block(a) ? ground_.distances(a) : nullptr; }, no_gap_known,
      distance);
  scatter_gaps<Dim, Shape>(P_, grid_.first_particle(b), grid_.last_particle(b), constants_, corner(b), h1_, distance,
                           gap);
}

}  // namespace tailrun::mpm

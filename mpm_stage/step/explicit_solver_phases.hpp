// The phases of the explicit step, in the order in which explicit_solver.hpp runs them; included there.
//
// Blocks hold very different numbers of particles, so threads take them a few at a time; what a block computes does not
// depend on who computes it.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::gather(double dt, StepReport& report) {
  const auto since = Clock::now();
  constexpr bool Flip = Transfer == TransferName::flip || Transfer == TransferName::aflip;
  constexpr bool Affine = Transfer == TransferName::apic || Transfer == TransferName::aflip;
  // Particles that start without affine velocities, whatever their velocities, take them from the grid as they are.
  const bool take_affine = !(time_ > 0.0 || starts_with_spin_);
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    Vec4 tile[tile_nodes], change[Flip && separate_change ? tile_nodes : 1];
    int loaded = -1;
    const auto load = [&](int f) {
      if (f == loaded) return;
      loaded = f;
      if constexpr (Dim == 2 && !Flip)
        load_tile<Dim, Shape>(grid_, b, velocity_.data() + node_of(f, 0), tile, [](Vec4 v) { return twice(v); });
      else
        load_tile<Dim, Shape>(grid_, b, velocity_.data() + node_of(f, 0), tile);
    };
    if (averaging_) will_write(averaged_tiles_.data() + b * tile_nodes, tile_nodes);
    BlockMotion motion;
    if (sleep_.asleep(b) && sleeps_on(b, tile, load, dt)) {
      motion_[b] = BlockMotion{.wave = wave_speed_in(b), .asleep = true};
      if (averaging_ && sleep_.stale(b)) scatter_average(b);
      continue;
    }
    int changed = -1;
    for (const Run& run : grid_.runs(b)) {
      load(run.field);
      if constexpr (Flip && separate_change)
        if (run.field != changed) load_tile<Dim, Shape>(grid_, b, change_.data() + node_of(run.field, 0), change);
      changed = run.field;
      const double flip = flip_share(dt, constants_[run.material]);
      const GridToParticles s{dt, h1_, flip, take_affine ? 0.0 : flip};
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
      // Linear functions take a particle on a line of nodes for one beside it, and let it through a wall by that.
      const bool grazes = wall_nodes_.side[d][over].kind != WallKind::open &&
                          (under ? walls_.low[d] - x : x - walls_.high[d]) < grazing * h_;
      if (walls_.leaving != LeavingParticles::wall && !grazes) {
        motion.outside = true;
        continue;
      }
      x = under ? walls_.low[d] : walls_.high[d];
      if (!held_.empty()) held_[static_cast<std::size_t>(P_.identity[p])] = 1;
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
    gather_tiles<Dim, Shape>(grid_.tiles_around(a), averaged_tiles_.data(), sum);
    fit_patches<Dim>(sum, averaged_.data() + a * block_nodes, sparse_);
    if (filling_.active()) filling_.compare(a, sum);
  }
  if (filling_.active()) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a) filling_.judge(a, averaged_.data() + a * block_nodes);
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
      if (sleep_.stale(b)) {
        sleep_.put_on_nodes(b);
        scatter_block(b);
      } else if (surface_age_.due() && fields_.near_shared(b)) {
        scatter_interfaces(b);
      }
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
    work_.crowding += stress_work_[b].crowding;
  }
  if (water_.any()) book_water();
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
        work.crowding += gather_volumetric<Dim, Shape>(k, P_, begin, end, corner(b), h1_, fit, filling_.relief(), trace,
                                                       sparse_.active());
      } else {
        own_volumetric(P_, begin, end, trace);
      }
      if (inverts(trace, end - begin)) return {std::nan(""), 0.0, 0.0};
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
  fields_.for_each_span(b, [&](const FieldSpan& span) {
    const std::size_t first = fields_.tile(span.field, b) * tile_nodes;
    Vec4* tile = tiles_.data() + first;
    SplitNode<Dim>* beside = Split ? beside_.data() + first : nullptr;
    std::fill(tile, tile + tile_nodes, Vec4{});
    if constexpr (Split) std::fill(beside, beside + tile_nodes, SplitNode<Dim>{});
    if (P_.pore_pressure.empty())
      mpm::particles_to_grid<Shape, Split, false>(next_dt_, h1_, corner(b), P_, span.begin, span.end, tile, beside);
    else
      mpm::particles_to_grid<Shape, Split, true>(next_dt_, h1_, corner(b), P_, span.begin, span.end, tile, beside);
    if (water_.any())
      water_.template scatter<Shape, Split>(grid_, b, next_dt_, corner(b), P_, span.begin, span.end, tile, beside);
  });
  if (surface_age_.due() && fields_.near_shared(b)) scatter_interfaces(b);
  if (ground_.any()) scatter_ground_gaps(b);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::water_potential(const std::vector<double>& levels) const {
  std::vector<double> of_block(grid_.occupied());
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b)
    of_block[b] = water_.template potential<Shape>(grid_, b, corner(b), P_, levels);
  return std::accumulate(of_block.begin(), of_block.end(), 0.0);
}

// While level and shares stay as they are, what the water's potential has lost is what it has done to the particles.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::book_water() {
  const double now = water_potential(water_levels_);
  work_.external += water_potential_ - now;
  const std::vector<double> levels = water_.levels();
  water_potential_ = levels == water_levels_ ? now : water_potential(levels);
  water_levels_ = levels;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_ground_gaps(std::size_t b) {
  double distance[tile_nodes];
  const bool near = ground_.near_ground(b);
  if (near)
    load_tile_if<Dim, Shape>(
        grid_, b, [this](std::size_t a) { return ground_.of_block(a) ? ground_.distances(a) : nullptr; }, no_gap_known,
        distance);
  fields_.for_each_span(b, [&](const FieldSpan& span) {
    Gap<Dim>* gap = gap_tiles_.data() + fields_.tile(span.field, b) * tile_nodes;
    std::fill(gap, gap + tile_nodes, Gap<Dim>{});
    if (near) scatter_gaps<Dim, Shape>(P_, span.begin, span.end, constants_, corner(b), h1_, distance, gap);
  });
}

}  // namespace tailrun::mpm

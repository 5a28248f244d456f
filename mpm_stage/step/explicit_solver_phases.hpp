// The phases of the explicit step, in the order in which explicit_solver.hpp runs them; included there.
//
// Blocks hold very different numbers of particles, so threads take them a few at a time; what a block computes does not
// depend on who computes it.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// The grains' volume is what counts: at most a quarter more than that of the material's loosest particle at the start,
// about what lies between a loose sand's void ratio and the loosest possible (0.8 and 1.2).
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::limit_volumes() {
  std::vector<double> loosest(constants_.size(), 0.0);
  for (std::size_t p = 0; p < P_.count(); ++p)
    loosest[P_.material[p]] = std::max(loosest[P_.material[p]], P_.volume[p] / P_.mass[p]);
  for (std::size_t m = 0; m < constants_.size(); ++m)
    if (loosest[m] > 0.0) constants_[m].largest_specific_volume = 1.25 * loosest[m];
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::sort() {
  const auto since = Clock::now();
  std::vector<std::uint8_t> keep;
  if (leaving_) {
    keep.assign(P_.count(), 1);
    for (std::size_t p = 0; p < P_.count(); ++p)
      for (int d = 0; d < Dim; ++d)
        if (P_.position[d][p] < walls_.low[d] || P_.position[d][p] > walls_.high[d]) keep[p] = 0;
    for (std::size_t p = 0; p < P_.count(); ++p) {
      if (keep[p]) continue;
      if (walls_.leaving == LeavingParticles::error) fail(p, p + 1, "left the domain (see domain/leaving_particles)");
      removed_.push_back(P_.identity[p]);
      work_.removed += 0.5 * P_.mass[p] * speed_squared(p);
    }
  }
  grid_.sort(P_, keep);
  if (grid_.occupied() == 0) throw ComputationError("no particle is left in the domain");
  lay_out();
  ++sorts_;
  drift_ = 0.0;
  leaving_ = false;

  // Wave speeds follow the lowest density of each material.
  std::vector<double> density(constants_.size(), 1e300);
  for (std::size_t p = 0; p < P_.count(); ++p)
    density[P_.material[p]] = std::min(density[P_.material[p]], P_.mass[p] / P_.volume[p]);
  wave_speed_.assign(constants_.size(), 0.0);
  viscous_limit_ = 1e30;
  for (std::size_t m = 0; m < constants_.size(); ++m) {
    if (density[m] > 1e299) continue;
    wave_speed_[m] = std::sqrt(constants_[m].wave_modulus() / density[m]);
    if (constants_[m].model == Model::newtonian_fluid && constants_[m].consistency > 0.0)
      viscous_limit_ =
          std::min(viscous_limit_, options_.courant * h_ * h_ * density[m] / (2.0 * Dim * constants_[m].consistency));
  }
  add_time(seconds_.sort, since);
}

// Memory and neighbours of the grid's blocks.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::lay_out() {
  ground_.update(grid_);
  mirrors_.update(grid_, wall_nodes_, Shape::support == 4 ? 2 : 1);
  tiles_.resize(grid_.occupied() * tile_nodes);
  if (Split) forces_.resize(tiles_.size());
  velocity_.resize(grid_.active() * block_nodes);
  if (separate_change) change_.resize(velocity_.size());
  if (mirrors_.any()) {
    sums_.resize(velocity_.size());
    if (Split) force_sums_.resize(velocity_.size());
  }
  if (averaging_) {
    averaged_tiles_.resize(tiles_.size());
    averaged_.resize(velocity_.size());
  }
  if (ground_.any()) {
    gap_tiles_.resize(tiles_.size());
    grip_.resize(velocity_.size());
    spread_.resize(velocity_.size());
  }
  grid_sums_.resize(grid_.active());
  motion_.resize(grid_.occupied());
  stress_work_.resize(grid_.occupied());
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::update_grid(double dt, const std::array<double, Dim>& body,
                                                              const std::array<double, Dim>& inertial) {
  const auto since = Clock::now();
  constexpr int B = Block<Dim>::cells;
  bool shaken = false;
  for (const double a : inertial) shaken = shaken || a != 0.0;
  // Nodes at mirrors need their images' sums, so those are complete before any velocity is made.
  const bool mirrored = mirrors_.any();
  if (mirrored) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a) {
      gather_tiles<Dim, Shape>(grid_, a, tiles_.data(), sums_.data() + a * block_nodes);
      if constexpr (Split) gather_tiles<Dim, Shape>(grid_, a, forces_.data(), force_sums_.data() + a * block_nodes);
    }
    mirrors_.fold(sums_.data());
    if constexpr (Split) mirrors_.fold(force_sums_.data());
  }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    Vec4 own_sum[block_nodes], own_force[Split ? block_nodes : 1];
    const Vec4 *sum = own_sum, *force = own_force;
    if (mirrored) {
      sum = sums_.data() + a * block_nodes;
      force = Split ? force_sums_.data() + a * block_nodes : nullptr;
    } else {
      gather_tiles<Dim, Shape>(grid_, a, tiles_.data(), own_sum);
      if constexpr (Split) gather_tiles<Dim, Shape>(grid_, a, forces_.data(), own_force);
    }
    GridSums<Dim> sums;
    const NodeContact* contact = ground_.of_block(a);
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
      if constexpr (Split)
        if (options_.local_damping > 0.0)
          sums.damping += m * apply_local_damping<Dim>(options_.local_damping, dt, before, v);
      const std::array<double, Dim> pushed = v;
      if (contact && contact[n].count > 0)
        grip_[a * block_nodes + n] = stop_approach<Dim>(contact[n], m, std::max(0.0, gap[n].value) / dt, v);
      if (wall_nodes_.any) {
        std::array<int, Dim> node;
        for (int d = 0, k = n; d < Dim; ++d, k /= B) node[d] = grid_.active_index(a)[d] * B + k % B;
        apply_walls<Dim>(wall_nodes_, node, m, v, sums);
      }
      for (int d = 0; d < Dim; ++d) sums.impulse[d] += m * (v[d] - pushed[d]);
      if (shaken)
        for (int d = 0; d < Dim; ++d) sums.external += dt * m * inertial[d] * v[d];
      out = node_velocity<Dim>(v.data());
      if constexpr (Split) {
        for (int d = 0; d < Dim; ++d) before[d] = v[d] - before[d];
        if constexpr (separate_change) change_[a * block_nodes + n] = Vec4{};
        add_change(a * block_nodes + n, before);
      }
    }
    grid_sums_[a] = sums;
  }
  if (ground_.any()) rub_ground();
  if (mirrored) {
    mirrors_.reflect(velocity_.data());
    if constexpr (separate_change) mirrors_.reflect(change_.data());
  }
  for (const auto& s : grid_sums_) {
    work_.friction += s.friction;
    work_.damping += s.damping;
    work_.external += s.external;
    for (int d = 0; d < Dim; ++d) impulse_[d] += s.impulse[d];
  }
  add_time(seconds_.grid, since);
}

// The ground's friction on the nodes' velocities.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::rub_ground() {
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a)
    if (ground_.of_block(a))
      for (int n = 0; n < block_nodes; ++n) spread_[a * block_nodes + n] = spread_of(ground_, grip_, a, n);
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    if (!ground_.of_block(a)) continue;
    for (int n = 0; n < block_nodes; ++n) {
      const std::size_t k = a * block_nodes + n;
      if (grip_[k].mass <= 0.0) continue;
      std::array<double, Dim> v, lost{};
      for (int d = 0; d < Dim; ++d) v[d] = lost[d] = velocity_[k][d];
      grid_sums_[a].friction += apply_friction<Dim>(grip_[k], pooled_impulse(ground_, grip_, spread_, a, n), v);
      for (int d = 0; d < Dim; ++d) {
        lost[d] = v[d] - lost[d];
        grid_sums_[a].impulse[d] += grip_[k].mass * lost[d];
      }
      for (int d = 0; d < Dim; ++d) velocity_[k][d] = v[d];
      if constexpr (Split) add_change(k, lost);
    }
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::gather(double dt, StepReport& report) {
  const auto since = Clock::now();
  constexpr bool Flip = Transfer != TransferName::apic, Affine = Transfer != TransferName::flip;
  const GridToParticles s{dt, h1_, flip_share(dt)};
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    Vec4 tile[tile_nodes], change[Flip && separate_change ? tile_nodes : 1];
    load_tile<Dim, Shape>(grid_, b, velocity_.data(), tile);
    if constexpr (Flip && separate_change) load_tile<Dim, Shape>(grid_, b, change_.data(), change);
    BlockMotion motion;
    for (const Run& run : grid_.runs(b)) {
      const MotionExtremes e =
          mpm::grid_to_particles<Shape, Flip, Affine>(s, tile, change, corner(b), P_, run.begin, run.end);
      motion.far = std::max(motion.far, e.displacement);
      motion.fast = std::max(motion.fast, e.speed_squared);
      motion.wave = std::max(motion.wave, wave_speed_[run.material] + std::sqrt(e.speed_squared));
      motion.kinetic += e.kinetic;
    }
    if (walls_.bounded) mind_sides(b, motion);
    motion_[b] = motion;
    // The block's particles are still near the core. Should it be time to sort, this is done again after it.
    if (averaging_ && std::isfinite(motion.kinetic) && drift_ + motion.far * h1_ <= largest_drift) scatter_average(b);
  }
  double far = 0.0, fast = 0.0;
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
    leaving_ = leaving_ || m.outside;
    work_.removed += m.stopped;
  }
  report.maximum_speed = std::sqrt(fast);
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
  AveragedNode* tile = averaged_tiles_.data() + b * tile_nodes;
  std::fill(tile, tile + tile_nodes, AveragedNode{});
  for (const Run& run : grid_.runs(b))
    if (constants_[run.material].averaged)
      scatter_volumetric<Dim, Shape>(P_, run.begin, run.end, corner(b), h1_, body_, tile);
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
    AveragedNode node[block_nodes];
    gather_tiles<Dim, Shape>(grid_, a, averaged_tiles_.data(), node);
    for (int n = 0; n < block_nodes; ++n) averaged_[a * block_nodes + n] = node_mean(node[n]);
  }
  add_time(seconds_.volumetric, since);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::update_stresses(double dt) {
  const auto since = Clock::now();
#pragma omp parallel
  {
    std::vector<double> trace, shift;
#pragma omp for schedule(dynamic, 4)
    for (std::size_t b = 0; b < grid_.occupied(); ++b) {
      stress_work_[b] = update_stresses_of(b, dt, trace, shift);
      if (std::isfinite(stress_work_[b].dissipated)) scatter_block(b);
    }
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
StressWork ExplicitSolver<Dim, Shape, Split, Transfer>::update_stresses_of(std::size_t b, double dt,
                                                                           std::vector<double>& trace,
                                                                           std::vector<double>& shift) {
  NodeMean mean[tile_nodes];
  bool loaded = false;
  StressWork work;
  for (const Run& run : grid_.runs(b)) {
    trace.resize(std::max(trace.size(), run.end - run.begin));
    shift.resize(trace.size());
    if (constants_[run.material].averaged) {
      if (!loaded) load_tile<Dim, Shape>(grid_, b, averaged_.data(), mean);
      loaded = true;
      gather_volumetric<Dim, Shape>(P_, run.begin, run.end, corner(b), h1_, relaxation(run.material, dt), mean,
                                    trace.data(), shift.data());
    } else {
      for (std::size_t p = run.begin; p < run.end; ++p) {
        trace[p - run.begin] = trace_of(P_, p);
        shift[p - run.begin] = 0.0;
      }
    }
    bool inverted = false;
    for (std::size_t i = 0; i < run.end - run.begin; ++i) inverted |= !(std::fabs(trace[i]) < 1.0);
    if (inverted) return {std::nan(""), 0.0};
    const StressWork of_run =
        update_stress(constants_[run.material], P_, run.begin, run.end, trace.data(), shift.data(), dt);
    work.dissipated += of_run.dissipated;
    work.pore_pressure += of_run.pore_pressure;
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
  Vec4* force = Split ? forces_.data() + b * tile_nodes : nullptr;
  std::fill(tile, tile + tile_nodes, Vec4{});
  if constexpr (Split) std::fill(force, force + tile_nodes, Vec4{});
  const std::size_t begin = grid_.first_particle(b), end = grid_.last_particle(b);
  if (P_.pore_pressure.empty())
    mpm::particles_to_grid<Shape, Split, false>(next_dt_, h1_, corner(b), P_, begin, end, tile, force);
  else
    mpm::particles_to_grid<Shape, Split, true>(next_dt_, h1_, corner(b), P_, begin, end, tile, force);
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
  scatter_gaps<Dim, Shape>(P_, grid_.first_particle(b), grid_.last_particle(b), corner(b), h1_, distance, gap);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
SolverState<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::state() const {
  SolverState<Dim> s;
  s.blocks = grid_.occupied_indices();
  s.first = grid_.first_particles();
  s.wave_speed = wave_speed_;
  s.next_dt = next_dt_;
  s.viscous_limit = viscous_limit_;
  s.drift = drift_;
  s.fastest_wave = fastest_wave_;
  s.sorts = sorts_;
  s.work = work_;
  s.seconds = seconds_;
  s.impulse = impulse_;
  s.removed = removed_;
  s.held = held();
  return s;
}

// The nodes' sums are not kept: P2G makes the same ones again.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::resume(Particles<Dim> particles, const SolverState<Dim>& s) {
  P_ = std::move(particles);
  grid_.restore(s.blocks, s.first, P_.material);
  lay_out();
  wave_speed_ = s.wave_speed;
  next_dt_ = s.next_dt;
  viscous_limit_ = s.viscous_limit;
  drift_ = s.drift;
  fastest_wave_ = s.fastest_wave;
  sorts_ = s.sorts;
  work_ = s.work;
  seconds_ = s.seconds;
  impulse_ = s.impulse;
  removed_ = s.removed;
  for (const std::int32_t k : s.held) held_[static_cast<std::size_t>(k)] = 1;
  particles_to_grid();
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::unbalanced_force_ratio(const std::array<double, Dim>& body) const {
  AlignedVector<Vec4> momentum(grid_.occupied() * tile_nodes, Vec4{}), force(grid_.occupied() * tile_nodes, Vec4{});
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    const std::size_t begin = grid_.first_particle(b), end = grid_.last_particle(b);
    Vec4 *m = momentum.data() + b * tile_nodes, *f = force.data() + b * tile_nodes;
    if (P_.pore_pressure.empty())
      mpm::particles_to_grid<Shape, true, false>(0.0, h1_, corner(b), P_, begin, end, m, f);
    else
      mpm::particles_to_grid<Shape, true, true>(0.0, h1_, corner(b), P_, begin, end, m, f);
  }
  double unbalanced = 0.0, weight = 0.0;
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    Vec4 m[block_nodes], f[block_nodes];
    gather_tiles<Dim, Shape>(grid_, a, momentum.data(), m);
    gather_tiles<Dim, Shape>(grid_, a, force.data(), f);
    const NodeContact* contact = ground_.of_block(a);
    for (int n = 0; n < block_nodes; ++n) {
      if (m[n][0] <= mass_cutoff_ || (contact && contact[n].count > 0)) continue;
      bool held = false;
      for (int d = 0, k = n; d < Dim; ++d, k /= Block<Dim>::cells) {
        const int node = grid_.active_index(a)[d] * Block<Dim>::cells + k % Block<Dim>::cells;
        for (int s = 0; s < 2; ++s) {
          const auto& side = wall_nodes_.side[d][s];
          held = held || (side.kind != WallKind::open && (s == 0 ? node <= side.node : node >= side.node));
        }
      }
      if (held) continue;
      for (int d = 0; d < Dim; ++d) {
        const double g = m[n][0] * body[d], r = f[n][1 + d] + g;
        unbalanced += r * r;
        weight += g * g;
      }
    }
  }
  return weight > 0.0 ? std::sqrt(unbalanced / weight) : 0.0;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::fail(std::size_t begin, std::size_t end,
                                                       const std::string& what) const {
  // Names the particle that is not finite, else the fastest of the block.
  std::size_t worst = begin;
  double most = -1.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double s = speed_squared(p);
    if (!std::isfinite(s)) {
      worst = p;
      break;
    }
    if (s > most) {
      most = s;
      worst = p;
    }
  }
  std::string place;
  for (int d = 0; d < Dim; ++d) place += fmt::format("{}{:.6g}", d ? ", " : "", P_.position[d][worst]);
  throw ComputationError(fmt::format("particle {} of material '{}' at ({}) m, speed {:.4g} m/s, {}", P_.identity[worst],
                                     materials_[P_.material[worst]].name, place, std::sqrt(speed_squared(worst)),
                                     what));
}

}  // namespace tailrun::mpm

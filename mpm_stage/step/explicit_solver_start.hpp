// How the explicit solver comes to be: from a scene, and from a checkpoint; included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
ExplicitSolver<Dim, Shape, Split, Transfer>::ExplicitSolver(const SolverOptions& options, double cell_size,
                                                            std::array<double, Dim> origin, Particles<Dim> particles,
                                                            const std::vector<Material>& materials,
                                                            const Terrain& terrain, const Walls<Dim>& walls)
    : options_(options),
      h_(cell_size),
      h1_(1.0 / cell_size),
      grid_(cell_size, origin, Shape::shift),
      P_(std::move(particles)),
      materials_(materials),
      walls_(walls),
      bodies_(walls.bodies.size()),
      body_velocity_(walls.bodies.size()),
      ground_(terrain, options.contact_reach * cell_size),
      extension_(options.surface_share),
      sleep_(options.sleep),
      water_(options.ponds),
      filling_(0.0) {
  double mass = 0.0;
  for (const double m : P_.mass) mass += m;
  mass_cutoff_ = (options.mass_cutoff < 0.0 ? Shape::mass_cutoff : options.mass_cutoff) * mass /
                 static_cast<double>(std::max<std::size_t>(1, P_.count()));
  averaging_ = false;
  for (const auto& m : materials_) {
    constants_.push_back(constants_of(m, cell_size));
    constants_.back().averaged = constants_.back().averaged && options.volumetric_average;
    averaging_ = averaging_ || constants_.back().averaged;
  }
  if (averaging_) filling_ = PatchFilling<Dim>(options.crowding_relief);
  if constexpr (Dim == 2 && std::is_same_v<Shape, QuadraticShape>)
    if (averaging_ && options.courant > longest_courant<Shape>(Dim)) sparse_.cell = h_ * h_;
  limit_volumes();
  if (walls.bounded && walls.leaving == LeavingParticles::wall) {
    std::int32_t most = 0;
    for (const std::int32_t identity : P_.identity) most = std::max(most, identity);
    held_.assign(static_cast<std::size_t>(most) + 1, 0);
  }
  for (int d = 0; d < Dim; ++d)
    for (int s = 0; s < 2; ++s) {
      auto& side = wall_nodes_.side[d][s];
      side.kind = walls.bounded ? walls.side[d][s].kind : WallKind::open;
      side.friction = walls.side[d][s].friction;
      side.node = static_cast<int>(std::lround(((s == 0 ? walls.low[d] : walls.high[d]) - origin[d]) * h1_));
      wall_nodes_.any = wall_nodes_.any || side.kind != WallKind::open;
    }
  if (!Split) work_.transfer = work_.impact = std::nan("");
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::start(double limit) {
  water_.set_time(0.0);
  sort();
  for (std::size_t p = 0; p < P_.count(); ++p) {
    fastest_wave_ = std::max(fastest_wave_, wave_speed_[P_.material[p]] + std::sqrt(speed_squared(p)));
    kinetic_ += 0.5 * P_.mass[p] * speed_squared(p);
  }
  for (const auto& column : P_.affine)
    starts_with_spin_ =
        starts_with_spin_ || std::any_of(column.begin(), column.end(), [](double c) { return c != 0.0; });
  next_dt_ = longest_step(limit);
  particles_to_grid();
}

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
SolverState<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::state() const {
  SolverState<Dim> s;
  s.blocks = grid_.occupied_indices();
  s.first = grid_.first_particles();
  s.wave_speed = wave_speed_;
  s.next_dt = next_dt_;
  s.viscous_limit = viscous_limit_;
  s.drift = drift_;
  s.fastest_wave = fastest_wave_;
  s.kinetic = kinetic_;
  s.sorts = sorts_;
  s.work = work_;
  s.seconds = seconds_;
  s.impulse = impulse_;
  s.time = time_;
  s.bodies = bodies_;
  s.grip = grip_memory();
  s.removed = removed_;
  s.held = held();
  s.sleep_clocks = sleep_.clocks();
  for (const std::uint8_t meeting : meeting_) s.meeting.push_back(meeting == not_met ? not_met : met);
  s.ponds = water_.states();
  s.pond_shares = water_.shares();
  return s;
}

// The nodes' sums are not kept: P2G makes the same ones again.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::resume(Particles<Dim> particles, const SolverState<Dim>& s) {
  P_ = std::move(particles);
  grid_.restore(s.blocks, s.first, P_, options_.fields);
  lay_out();
  if (sleep_.active()) sleep_.restore(s.sleep_clocks);
  wave_speed_ = s.wave_speed;
  next_dt_ = s.next_dt;
  viscous_limit_ = s.viscous_limit;
  drift_ = s.drift;
  fastest_wave_ = s.fastest_wave;
  kinetic_ = s.kinetic;
  sorts_ = s.sorts;
  work_ = s.work;
  seconds_ = s.seconds;
  impulse_ = s.impulse;
  time_ = s.time;
  bodies_ = s.bodies;
  remember_grip(s.grip);
  meeting_.assign(s.meeting.begin(), s.meeting.end());
  removed_ = s.removed;
  for (const std::int32_t k : s.held) held_[static_cast<std::size_t>(k)] = 1;
  if (water_.any()) {
    water_.restore(grid_, s.pond_shares, s.ponds);
    water_levels_ = water_.levels();
    water_potential_ = water_potential(water_levels_);
  }
  particles_to_grid();
}

}  // namespace tailrun::mpm

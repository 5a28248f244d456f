// What ground and moving bodies do to the nodes after their approach has been stopped, and the nodes' kinetic energy
// after all of it; included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// The ground's friction on the nodes' velocities.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::rub_ground(const Drive& drive) {
  // Each loop takes all fields: threads meet once after it.
  const auto for_each_block = [this](auto action) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a)
      for (int f = 0; ground_.of_block(a) && f < fields_.count(); ++f)
        if (fields_.present(f, a)) action(f, a);
  };
  for_each_block([this](int f, std::size_t a) {
    for (std::size_t k = node_of(f, a); k < node_of(f, a) + block_nodes; ++k)
      if (grip_[k].mass > 0.0)
        grip_[k].sliding = grip_[k].mass * std::sqrt(square<Dim>(sliding_of<Dim>(grip_[k], velocity_at(k))));
  });
  for_each_block([this](int f, std::size_t a) {
    for (int n = 0; n < block_nodes; ++n)
      spread_[node_of(f, a) + static_cast<std::size_t>(n)] =
          spread_of<Dim>(ground_.contact_around(a), grip_.data() + node_of(f, 0), a, n);
  });
  for_each_block([this, &drive](int f, std::size_t a) { rub_block(f, a, drive); });
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::rub_block(int f, std::size_t a, const Drive& drive) {
  const Spread* spread = spread_.data() + node_of(f, 0);
  GridSums<Dim>& sums = grid_sums_[a];
  for (int n = 0; n < block_nodes; ++n) {
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    const NodeGrip& own = grip_[k];
    if (own.mass <= 0.0) continue;
    std::array<double, Dim> v, lost{};
    for (int d = 0; d < Dim; ++d) v[d] = lost[d] = velocity_[k][d];
    sums.friction += apply_friction<Dim>(own, pooled_impulse<Dim>(ground_.contact_around(a), own, spread, n), v);
    for (int d = 0; d < Dim; ++d) {
      lost[d] = v[d] - lost[d];
      sums.impulse[d] += own.mass * lost[d];
      sums.external += drive.dt * own.mass * drive.inertial[d] * lost[d];
      velocity_[k][d] = v[d];
    }
    if constexpr (Split) {
      add_change(k, lost);
      for (int d = 0; d < Dim; ++d) {
        sums.kinetic_after += own.mass * lost[d] * (v[d] - 0.5 * lost[d]);
        sums.impact += 0.5 * own.mass * lost[d] * change_of(k, d);
      }
    }
  }
}

// Kinetic energy of the nodes as they move the particles, where walls and surface have changed it after contact.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::sum_kinetic_after() {
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    double twice = 0.0;
    for (int f = 0; f < fields_.count(); ++f) {
      if (!fields_.present(f, a)) continue;
      for (std::size_t k = node_of(f, a); k < node_of(f, a) + block_nodes; ++k) {
        if (sums_[k][0] <= mass_cutoff_) continue;
        for (int d = 0; d < Dim; ++d) twice += sums_[k][0] * velocity_[k][d] * velocity_[k][d];
      }
    }
    grid_sums_[a].kinetic_after = 0.5 * twice;
  }
}

// What local damping took: as with contact, an impulse J costs - J . (v + v') / 2, v and v' the node's velocities at
// the step's ends.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::book_damping() {
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    double lost = 0.0;
    for (int f = 0; f < fields_.count(); ++f)
      for (std::size_t k = node_of(f, a); k < node_of(f, a) + block_nodes; ++k)
        for (int d = 0; d < Dim; ++d) lost += damped_[k][d] * (velocity_[k][d] - 0.5 * change_of(k, d));
    grid_sums_[a].damping = lost;
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::move_bodies(double dt) {
  nodes_in_bodies_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::array<double, Dim>& v = body_velocity_[b] = walls_.bodies[b].velocity_at(time_ + 0.5 * dt);
    for (int f = 0; f < fields_.count(); ++f) {
      const std::size_t first = node_of(f, 0);
      const auto changed = [this, b, first](std::size_t node, const std::array<double, Dim>& dv) {
        [[maybe_unused]] const std::size_t k = first + node;
        if constexpr (Split) {
          add_change(k, dv);
          for (int d = 0; d < Dim; ++d) work_.impact += 0.5 * sums_[k][0] * dv[d] * change_of(k, d);
        }
        if constexpr (Transfer == TransferName::fmpm) nodes_in_bodies_.push_back({k, b});
      };
      work_.external += push_nodes<Dim>(grid_, walls_.bodies[b], v, sums_.data() + first, mass_cutoff_,
                                        velocity_.data() + first, bodies_[b], changed);
    }
    for (int d = 0; d < Dim; ++d) bodies_[b].displacement[d] += dt * v[d];
  }
}

}  // namespace tailrun::mpm

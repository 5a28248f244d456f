// What the ground's friction does to the nodes after their approach has been stopped, and the nodes' kinetic energy
// after all contact; included by explicit_solver.hpp.
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

}  // namespace tailrun::mpm

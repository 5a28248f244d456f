// Moving bodies (boundary/moving_bodies.hpp) in a step; included by explicit_solver.hpp.
//
// A node inside a body has the body's velocity, so nothing else touches it: neither another field nor ground nor walls.
// It gets that velocity before friction is shared out, which nodes beside it take part in.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// Which nodes the bodies hold in this step; of two bodies in one place the later one.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::find_nodes_in_bodies(double dt) {
  body_of_node_.assign(grid_.active() * block_nodes, no_body);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    body_velocity_[b] = walls_.bodies[b].velocity_at(time_ + 0.5 * dt);
    for_each_node_inside<Dim>(grid_, walls_.bodies[b], bodies_[b],
                              [this, b](std::size_t k) { body_of_node_[k] = static_cast<std::uint16_t>(b); });
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
bool ExplicitSolver<Dim, Shape, Split, Transfer>::in_body(std::size_t a, int n) const {
  return !bodies_.empty() && body_of_node_[a * block_nodes + static_cast<std::size_t>(n)] != no_body;
}

// Gives the nodes in bodies their velocities, and moves the bodies on.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::push_nodes(const Drive& drive) {
  nodes_in_bodies_.clear();
  for (std::size_t a = 0; a < grid_.active(); ++a)
    for (int n = 0; n < block_nodes; ++n) {
      if (!in_body(a, n)) continue;
      const std::size_t b = body_of_node_[a * block_nodes + static_cast<std::size_t>(n)];
      for (int f = 0; f < fields_.count(); ++f) {
        if (!fields_.present(f, a)) continue;
        const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
        if (sums_[k][0] <= mass_cutoff_) continue;
        push_node(k, b, drive);
        nodes_in_bodies_.push_back({k, b});
      }
    }
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    for (int d = 0; d < Dim; ++d) bodies_[b].displacement[d] += drive.dt * body_velocity_[b][d];
}

// What the node loses is the soil's push on the body. An impulse J costs the node - J . (v + v') / 2, v and v' its
// velocities at the step's ends, and the body gives J . v'.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::push_node(std::size_t k, std::size_t b, const Drive& drive) {
  const double m = sums_[k][0];
  std::array<double, Dim> dv;
  for (int d = 0; d < Dim; ++d) {
    dv[d] = body_velocity_[b][d] - velocity_[k][d];
    bodies_[b].impulse[d] -= m * dv[d];
    work_.external += m * dv[d] * (body_velocity_[b][d] + drive.dt * drive.inertial[d]);
    velocity_[k][d] = body_velocity_[b][d];
  }
  if constexpr (Split) {
    add_change(k, dv);
    for (int d = 0; d < Dim; ++d) work_.impact += 0.5 * m * dv[d] * change_of(k, d);
  }
}

}  // namespace tailrun::mpm

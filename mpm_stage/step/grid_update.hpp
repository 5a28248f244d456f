// The grid step of one node: forces and body acceleration, damping and walls.
#pragma once

#include <array>
#include <cmath>

#include "mpm_stage/boundary/wall_contact.hpp"
#include "mpm_stage/boundary/wall_nodes.hpp"
#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/transfer/mass_matrix.hpp"

namespace tailrun::mpm {

// Sums over the nodes of one block (J; N s), added up in the order of the blocks afterwards.
template <int Dim>
struct GridSums {
  double friction = 0.0, contact = 0.0, damping = 0.0, external = 0.0, impact = 0.0;
  double kinetic_before = 0.0, kinetic_after = 0.0;  // of the nodes, at the step's ends
  std::array<double, Dim> impulse{};

  GridSums& operator+=(const GridSums& o) {
    friction += o.friction;
    contact += o.contact;
    damping += o.damping;
    external += o.external;
    impact += o.impact;
    kinetic_before += o.kinetic_before;
    kinetic_after += o.kinetic_after;
    for (int d = 0; d < Dim; ++d) impulse[d] += o.impulse[d];
    return *this;
  }
};

template <int Dim>
inline double square(const std::array<double, Dim>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

// One step of a block's nodes that nothing touches: v = p / m + dt (f / m + b), with Split; without it the momentum p
// has the forces in it. `acceleration` is b (m/s2) in the first Dim lanes. Nodes with no more than `mass_cutoff` (kg)
// stay at rest. `velocity` gets what node_velocity() makes, and the change of velocity in lanes 2 and 3 in 2-D, in
// `change` in 3-D.
template <int Dim, bool Split>
GridSums<Dim> move_free_nodes(double dt, Vec4 acceleration, double mass_cutoff, const Vec4* sum, const Vec4* force,
                              Vec4* velocity, Vec4* change) {
  const Vec4 gain = dt * acceleration, at_rest = {};
  Vec4 before_squared = {}, after_squared = {};
  for (int n = 0; n < Block<Dim>::nodes; ++n) {
    const Vec4 m = splat(sum[n][0]), r = 1.0 / m;
    const auto light = m <= splat(mass_cutoff);
    const Vec4 before = light ? at_rest : as_velocity<Dim>(sum[n]) * r;
    Vec4 v = before + gain;
    if constexpr (Split) v += as_velocity<Dim>(force[n]) * (dt * r);
    v = light ? at_rest : v;
    if constexpr (Split) {
      before_squared += m * (before * before);
      after_squared += m * (v * v);
      const Vec4 dv = v - before;
      velocity[n] = Dim == 2 ? __builtin_shufflevector(v, dv, 0, 1, 4, 5) : v;
      if constexpr (Dim == 3) change[n] = dv;
    } else {
      velocity[n] = v;
    }
  }
  GridSums<Dim> sums;
  sums.kinetic_before = 0.5 * sum_of_lanes(before_squared);
  sums.kinetic_after = 0.5 * sum_of_lanes(after_squared);
  return sums;
}

// Cundall's local damping: a force of `alpha` times the unbalanced one against the motion. Returns the impulse that
// it takes (N s). What work that is, is known only when walls and ground have had their say: a node that they hold does
// none.
template <int Dim>
inline std::array<double, Dim> apply_local_damping(double alpha, double mass, const std::array<double, Dim>& before,
                                                   std::array<double, Dim>& after) {
  std::array<double, Dim> taken{};
  for (int d = 0; d < Dim; ++d) {
    if (before[d] == 0.0) continue;
    const double change = std::copysign(alpha * std::fabs(after[d] - before[d]), before[d]);
    after[d] -= change;
    taken[d] = mass * change;
  }
  return taken;
}

// Node planes at and beyond a frictional wall; fixed and slip walls are mirrors (mirror_walls.hpp).
template <int Dim>
inline void apply_walls(const WallNodes<Dim>& walls, const std::array<int, Dim>& node, double mass,
                        std::array<double, Dim>& v, GridSums<Dim>& sums) {
  for (int d = 0; d < Dim; ++d)
    for (int s = 0; s < 2; ++s) {
      const auto& side = walls.side[d][s];
      if (side.kind == WallKind::open || (s == 0 ? node[d] > side.node : node[d] < side.node)) continue;
      if (side.kind == WallKind::frictional) {
        std::array<double, Dim> n{};
        n[d] = s == 0 ? 1.0 : -1.0;
        sums.friction += mass * apply_wall_contact<Dim>(v, n, side.friction);
      }
    }
}

}  // namespace tailrun::mpm

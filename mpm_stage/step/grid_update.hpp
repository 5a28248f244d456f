// The grid step of one node: forces and body acceleration, damping and walls.
#pragma once

#include <array>
#include <cmath>

#include "mpm_stage/boundary/wall_contact.hpp"
#include "mpm_stage/boundary/walls.hpp"

namespace tailrun::mpm {

// Sums over the nodes of one block (J; N s), added up in the order of the blocks afterwards.
template <int Dim>
struct GridSums {
  double friction = 0.0, damping = 0.0, external = 0.0, impact = 0.0;
  double kinetic_before = 0.0, kinetic_after = 0.0;  // of the nodes, at the step's ends
  std::array<double, Dim> impulse{};
};

template <int Dim>
inline double square(const std::array<double, Dim>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

// Walls in numbers of nodes from the grid's origin.
template <int Dim>
struct WallNodes {
  struct Side {
    WallKind kind = WallKind::open;
    int node = 0;
    double friction = 0.0;
  };
  std::array<std::array<Side, 2>, Dim> side{};
  bool any = false;
};

// Cundall's local damping: a force of `alpha` times the unbalanced one against the motion.
template <int Dim>
inline double apply_local_damping(double alpha, double dt, const std::array<double, Dim>& before,
                                  std::array<double, Dim>& after) {
  double lost = 0.0;
  for (int d = 0; d < Dim; ++d) {
    const double a = (after[d] - before[d]) / dt;
    if (before[d] == 0.0) continue;
    const double taken = std::copysign(alpha * std::fabs(a) * dt, before[d]);
    const double v = after[d] - taken;
    lost += taken * v;
    after[d] = v;
  }
  return lost;
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

// Where nodes are held: the sides of the grid, planes of nodes, and bodies that move as prescribed.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mpm_stage/boundary/moving_bodies.hpp"

namespace tailrun::mpm {

enum class WallKind { open, fixed, slip, frictional };

// What happens to particles beyond a side of the domain: the run stops, they are taken out, or they are held there.
enum class LeavingParticles { error, remove, wall };

template <int Dim>
struct Walls {
  struct Side {
    WallKind kind = WallKind::open;
    double friction = 0.0;  // 1, frictional only
  };
  bool bounded = false;                   // without a domain the grid is endless and has no walls
  std::array<double, Dim> low{}, high{};  // m, on nodes
  std::array<std::array<Side, 2>, Dim> side{};
  LeavingParticles leaving = LeavingParticles::error;
  std::vector<MovingBody<Dim>> bodies;

  bool any_wall() const {
    for (const auto& pair : side)
      for (const auto& s : pair)
        if (s.kind != WallKind::open) return true;
    return false;
  }
};

}  // namespace tailrun::mpm

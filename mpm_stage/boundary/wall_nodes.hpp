// The walls of a grid as its nodes see them: which plane of nodes each one is.
#pragma once

#include <array>

#include "mpm_stage/boundary/walls.hpp"

namespace tailrun::mpm {

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

  bool any_frictional() const {
    for (const auto& both : side)
      if (both[0].kind == WallKind::frictional || both[1].kind == WallKind::frictional) return true;
    return false;
  }
};

// Share of a node's cells that lie inside the walls, for a node that has none beyond them.
template <int Dim>
inline double share_inside(const WallNodes<Dim>& walls, const std::array<int, Dim>& node) {
  double share = 1.0;
  if (!walls.any) return share;
  for (int d = 0; d < Dim; ++d)
    for (const auto& side : walls.side[d])
      if (side.kind != WallKind::open && node[d] == side.node) share *= 0.5;
  return share;
}

}  // namespace tailrun::mpm

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

}  // namespace tailrun::mpm

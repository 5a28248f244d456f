// What a particle covers of the ground's surface (ground_cover.hpp), as the nodes in its reach see it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/boundary/ground_cover.hpp"

namespace tailrun::mpm {

// `Support` nodes in each direction from `base` on.
template <int Dim, int Support>
class CoveredGround {
 public:
  // Nothing.
  CoveredGround() = default;
  // `X` is the particle's place in the tile, `size` its width and `height` its distance from the ground, all in cells;
  // `away` is the direction in which the distance grows.
  CoveredGround(const double* X, const int* base, double size, double height, const std::array<double, Dim>& away) {
    const double length = std::hypot(away[0], away[1]);
    if (!(height < GroundCover<Dim>::thickness && length > 0.0)) return;
    for (int axis = 0; axis < 2; ++axis) {
      const double foot = X[axis] - height * away[axis] / length;
      // Along the slope it is as wide as on level ground; nodes look along the axis that is nearer to the slope.
      const double half = 0.5 * size * std::max(std::sqrt(0.5), std::fabs(away[1 - axis]) / length);
      Line::template under<Support>(foot - base[axis], half, along_[axis]);
    }
    if constexpr (Dim == 3) {
      Line::template under<Support>(X[2] - base[2], 0.5 * size, across_);
      for (auto& line : across_) line = GroundCover<3>::rows_at(line);
    }
  }

  // As seen from node (i, j, k), counted from `base`.
  GroundCover<Dim> from(int i, int j, [[maybe_unused]] int k) const {
    if constexpr (Dim == 2)
      return {{along_[0][i], along_[1][j]}};
    else
      return {{along_[0][i] * across_[k], along_[1][j] * across_[k]}};
  }

 private:
  using Line = typename GroundCover<Dim>::Line;
  typename Line::Bits along_[2][Support] = {}, across_[Support] = {};
};

}  // namespace tailrun::mpm

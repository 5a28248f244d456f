// Fixed and slip walls of the grid as mirrors. B-splines reach over a wall, so holding the nodes on it would leave the
// material next to it free by an eighth. Instead the nodes near a wall receive what the body's mirror image would give
// them: normal momentum (at a fixed wall all of it) changes sign in the mirror. The velocity field is then odd about
// the wall, the body moves as half of a symmetric whole, and the order of the scheme holds up to the wall.
#pragma once

#include <cstddef>
#include <vector>

#include "mpm_stage/boundary/wall_nodes.hpp"
#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

template <int Dim>
class MirrorWalls {
 public:
  // Nodes within `reach` nodes of a wall, looked up after each sort.
  void update(const BlockGrid<Dim>& grid, const WallNodes<Dim>& walls, int reach);

  bool any() const { return !pairs_.empty(); }
  // Adds the mirror image's mass and momentum (lanes 0 and 1 .. Dim) to the nodes inside and empties those behind the
  // wall, so that nothing is computed, damped or counted twice there.
  void fold(Vec4* sums) const;
  // Sets the velocities on the walls and, mirrored, behind them. Vec4 as node_velocity makes it.
  void reflect(Vec4* velocity) const;

 private:
  struct Pair {
    std::size_t inside;     // node in arrays of Block::nodes values per active block
    std::ptrdiff_t behind;  // its image, -1: not in any active block; equal to `inside` on the wall
    int direction;
    bool fixed;
  };
  std::vector<Pair> pairs_;  // direction by direction
};

}  // namespace tailrun::mpm

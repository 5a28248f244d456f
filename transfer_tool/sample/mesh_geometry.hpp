// What the hand-over asks of a snapshot's mesh: corners of an element before and after deformation, its outline, and
// the depth of a place below the initial ground surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/snapshot.hpp"
#include "transfer_tool/sample/quadrilateral.hpp"

namespace tailrun::transfer {

Corners initial_corners(const Snapshot& snapshot, std::size_t element);
Corners deformed_corners(const Snapshot& snapshot, std::size_t element);

// A side of an element, walked with the element on its left; `neighbour` is the element on the other side or -1.
struct ElementSide {
  std::int64_t from = 0, to = 0;  // nodes
  std::int64_t element = 0, neighbour = -1;
};

// Every side of every element: four per element, in the elements' order. Throws InputError when three or more elements
// share a side.
std::vector<ElementSide> element_sides(const Snapshot& snapshot);

// The initial ground surface: the highest outline of the undeformed mesh above each x.
class GroundSurface {
 public:
  explicit GroundSurface(const Snapshot& snapshot);
  // y of the surface at x (m); x beyond the mesh takes the nearest end.
  double height(double x) const;
  double depth(double x, double y) const { return height(x) - y; }

 private:
  struct Piece {
    double x0, y0, x1, y1;  // x0 < x1
  };
  std::vector<Piece> pieces_;                     // sides that face up
  std::vector<double> bin_edges_;                 // equal bins in x
  std::vector<std::vector<std::uint32_t>> bins_;  // pieces that cross each bin
};

}  // namespace tailrun::transfer

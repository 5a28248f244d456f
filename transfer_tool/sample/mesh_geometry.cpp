#include "transfer_tool/sample/mesh_geometry.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/error.hpp"

namespace tailrun::transfer {

Corners initial_corners(const Snapshot& snapshot, std::size_t element) {
  Corners corners;
  for (std::size_t a = 0; a < 4; ++a) {
    const auto node = static_cast<std::size_t>(snapshot.quads[4 * element + a]);
    corners[a] = {snapshot.position[2 * node], snapshot.position[2 * node + 1]};
  }
  return corners;
}

Corners deformed_corners(const Snapshot& snapshot, std::size_t element) {
  Corners corners = initial_corners(snapshot, element);
  for (std::size_t a = 0; a < 4; ++a) {
    const auto node = static_cast<std::size_t>(snapshot.quads[4 * element + a]);
    corners[a][0] += snapshot.displacement[2 * node];
    corners[a][1] += snapshot.displacement[2 * node + 1];
  }
  return corners;
}

std::vector<ElementSide> element_sides(const Snapshot& snapshot) {
  std::vector<ElementSide> sides;
  sides.reserve(4 * snapshot.elements());
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> first_seen;
  for (std::size_t element = 0; element < snapshot.elements(); ++element)
    for (std::size_t a = 0; a < 4; ++a) {
      const std::int64_t from = snapshot.quads[4 * element + a], to = snapshot.quads[4 * element + (a + 1) % 4];
      sides.push_back({from, to, static_cast<std::int64_t>(element), -1});
      const auto [place, is_new] = first_seen.emplace(std::minmax(from, to), sides.size() - 1);
      if (is_new) continue;
      ElementSide& other = sides[place->second];
      if (other.neighbour >= 0)
        throw InputError(
            fmt::format("the snapshot's mesh: elements {}, {} and {} share the side between nodes {} and {}",
                        other.element, other.neighbour, element, from, to));
      other.neighbour = static_cast<std::int64_t>(element);
      sides.back().neighbour = other.element;
    }
  return sides;
}

GroundSurface::GroundSurface(const Snapshot& snapshot) {
  double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low;
  for (const auto& side : element_sides(snapshot)) {
    if (side.neighbour >= 0) continue;
    const auto from = static_cast<std::size_t>(side.from), to = static_cast<std::size_t>(side.to);
    const double x1 = snapshot.position[2 * from], y1 = snapshot.position[2 * from + 1];
    const double x0 = snapshot.position[2 * to], y0 = snapshot.position[2 * to + 1];
    // With the element on its left, a side that is walked towards smaller x has the element below it.
    if (!(x0 < x1)) continue;
    pieces_.push_back({x0, y0, x1, y1});
    x_low = std::min(x_low, x0);
    x_high = std::max(x_high, x1);
  }
  if (pieces_.empty())
    throw InputError("the snapshot's mesh has no side that faces up: its quadrilaterals run clockwise");
  const std::size_t count = std::max<std::size_t>(1, pieces_.size());
  for (std::size_t i = 0; i <= count; ++i)
    bin_edges_.push_back(x_low + (x_high - x_low) * static_cast<double>(i) / static_cast<double>(count));
  bins_.resize(count);
  for (std::uint32_t i = 0; i < pieces_.size(); ++i)
    for (std::size_t bin = 0; bin < count; ++bin)
      if (pieces_[i].x0 <= bin_edges_[bin + 1] && pieces_[i].x1 >= bin_edges_[bin]) bins_[bin].push_back(i);
}

double GroundSurface::height(double x) const {
  const double inside = std::clamp(x, bin_edges_.front(), bin_edges_.back());
  const auto above = std::upper_bound(bin_edges_.begin(), bin_edges_.end(), inside) - bin_edges_.begin();
  const auto bin = std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - 1, 0)), bins_.size() - 1);
  double highest = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : bins_[bin]) {
    const Piece& piece = pieces_[i];
    if (inside < piece.x0 || inside > piece.x1) continue;
    highest = std::max(highest, piece.y0 + (piece.y1 - piece.y0) * (inside - piece.x0) / (piece.x1 - piece.x0));
  }
  if (std::isfinite(highest)) return highest;
  // Only an x inside a gap of the outline gets here: the nearest piece stands in.
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces_) {
    const double distance = std::max(piece.x0 - inside, inside - piece.x1);
    if (distance >= nearest_distance) continue;
    nearest_distance = distance;
    highest = inside < piece.x0 ? piece.y0 : piece.y1;
  }
  return highest;
}

}  // namespace tailrun::transfer

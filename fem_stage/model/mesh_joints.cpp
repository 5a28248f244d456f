#include "fem_stage/model/mesh_joints.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

constexpr double share_of_side = 0.01;

// m, (N): the shortest side of an element at each node.
std::vector<double> shortest_sides(const Mesh& mesh) {
  std::vector<double> side(mesh.nodes(), std::numeric_limits<double>::infinity());
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = static_cast<std::size_t>(mesh.quads[4 * e + a]),
                 q = static_cast<std::size_t>(mesh.quads[4 * e + (a + 1) % 4]);
      const double length = std::hypot(mesh.x(p) - mesh.x(q), mesh.y(p) - mesh.y(q));
      side[p] = std::min(side[p], length);
      side[q] = std::min(side[q], length);
    }
  return side;
}

// Nodes of a free field's side and of its column, by pair of lines.
using Sides = std::vector<std::array<std::set<std::int64_t>, 2>>;

Sides free_field_sides(const Mesh& mesh, const BoundaryOptions& boundaries) {
  Sides sides;
  for (const auto& side : boundaries.free_field) {
    std::array<std::set<std::int64_t>, 2> pair;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto it = mesh.lines.find(k == 0 ? side.line : side.column_line);
      if (it == mesh.lines.end()) continue;  // the boundary says so
      for (const auto& edge : it->second) pair[k].insert(edge.begin(), edge.end());
    }
    sides.push_back(std::move(pair));
  }
  return sides;
}

}  // namespace

void check_joints(const Mesh& mesh, const BoundaryOptions& boundaries, const std::string& source) {
  const auto side = shortest_sides(mesh);
  const Sides free_field = free_field_sides(mesh, boundaries);
  const double widest = share_of_side * *std::max_element(side.begin(), side.end());
  std::vector<std::size_t> order(mesh.nodes());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return mesh.x(a) < mesh.x(b); });
  std::size_t pairs = 0, first = 0, second = 0;
  double largest_gap = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && mesh.x(order[j]) - mesh.x(order[i]) <= widest; ++j) {
      const std::size_t a = order[i], b = order[j];
      const double gap = std::hypot(mesh.x(a) - mesh.x(b), mesh.y(a) - mesh.y(b));
      // Nodes of one element are a side apart at least, or a diagonal, so they do not come in here.
      if (gap > share_of_side * std::min(side[a], side[b])) continue;
      const auto na = static_cast<std::int64_t>(a), nb = static_cast<std::int64_t>(b);
      const bool meant = std::any_of(free_field.begin(), free_field.end(), [&](const auto& pair) {
        return (pair[0].contains(na) && pair[1].contains(nb)) || (pair[0].contains(nb) && pair[1].contains(na));
      });
      if (meant) continue;
      if (pairs++ == 0) first = a, second = b;
      largest_gap = std::max(largest_gap, gap);
    }
  if (pairs > 0)
    throw InputError(
        fmt::format("{}: the mesh is cut: {} pairs of nodes lie in one place (up to {:.2g} m apart) and belong to "
                    "different elements, for "
                    "instance nodes {} and {} at ({:.4g}, {:.4g}). Parts that are to move together must share their "
                    "nodes: one curve "
                    "for both sides in the geometry (Coherence), or merge the nodes (Coherence Mesh)",
                    source, pairs, largest_gap, first, second, mesh.x(first), mesh.y(first)));
}

}  // namespace tailrun::fem

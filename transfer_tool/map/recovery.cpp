#include "transfer_tool/map/recovery.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

// Elements around each node.
std::vector<std::vector<std::int64_t>> elements_of_nodes(const Snapshot& snapshot) {
  std::vector<std::vector<std::int64_t>> around(snapshot.nodes());
  for (std::size_t i = 0; i < snapshot.quads.size(); ++i)
    around[static_cast<std::size_t>(snapshot.quads[i])].push_back(static_cast<std::int64_t>(i / 4));
  return around;
}

// Elements of the same region that share a node with `element`, itself included, each once.
std::vector<std::int64_t> neighbours(const Snapshot& snapshot, const std::vector<std::vector<std::int64_t>>& around,
                                     std::size_t element) {
  std::vector<std::int64_t> found;
  for (std::size_t a = 0; a < 4; ++a)
    for (const std::int64_t other : around[static_cast<std::size_t>(snapshot.quads[4 * element + a])])
      if (snapshot.region_id[static_cast<std::size_t>(other)] == snapshot.region_id[element]) found.push_back(other);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

// Elements with a side behind which there is no element of their region.
std::vector<bool> on_edge_of_region(const Snapshot& snapshot) {
  std::vector<bool> on_edge(snapshot.elements(), false);
  for (const auto& side : element_sides(snapshot)) {
    const auto element = static_cast<std::size_t>(side.element);
    if (side.neighbour < 0 ||
        snapshot.region_id[static_cast<std::size_t>(side.neighbour)] != snapshot.region_id[element])
      on_edge[element] = true;
  }
  return on_edge;
}

std::array<double, 2> centre_of_area(const Corners& corners) {
  const NodeWeights integral = integrated_shape_functions(corners);
  std::array<double, 2> centre{};
  double total = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    total += integral[a];
    centre[0] += integral[a] * corners[a][0];
    centre[1] += integral[a] * corners[a][1];
  }
  return {centre[0] / total, centre[1] / total};
}

}  // namespace

std::vector<double> nodal_recovery(const Snapshot& snapshot, const SamplePoints& points,
                                   const std::vector<double>& field, std::size_t columns) {
  const auto around = elements_of_nodes(snapshot);
  std::vector<double> areas(snapshot.elements());
  for (std::size_t e = 0; e < areas.size(); ++e) areas[e] = area(initial_corners(snapshot, e));

  std::vector<double> values(points.count() * columns);
  std::vector<double> corner(4 * columns);
  std::int64_t current = -1;
  for (std::size_t p = 0; p < points.count(); ++p) {
    const auto element = static_cast<std::size_t>(points.element[p]);
    if (points.element[p] != current) {
      current = points.element[p];
      std::fill(corner.begin(), corner.end(), 0.0);
      for (std::size_t a = 0; a < 4; ++a) {
        double weight = 0.0;
        for (const std::int64_t id : around[static_cast<std::size_t>(snapshot.quads[4 * element + a])]) {
          const auto other = static_cast<std::size_t>(id);
          if (snapshot.region_id[other] != snapshot.region_id[element]) continue;
          weight += areas[other];
          for (std::size_t k = 0; k < columns; ++k)
            corner[columns * a + k] += areas[other] * field[columns * other + k];
        }
        for (std::size_t k = 0; k < columns; ++k) corner[columns * a + k] /= weight;
      }
    }
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t k = 0; k < columns; ++k)
        values[columns * p + k] += points.node_weights[4 * p + a] * corner[columns * a + k];
  }
  return values;
}

std::vector<double> linear_recovery(const Snapshot& snapshot, const SamplePoints& points,
                                    const std::vector<double>& field, std::size_t columns) {
  const auto around = elements_of_nodes(snapshot);
  const auto on_edge = on_edge_of_region(snapshot);
  std::vector<std::array<double, 2>> centres(snapshot.elements());
  for (std::size_t e = 0; e < centres.size(); ++e) centres[e] = centre_of_area(initial_corners(snapshot, e));

  std::vector<double> values(points.count() * columns);
  for (std::size_t first = 0, last = 0; first < points.count(); first = last) {
    while (last < points.count() && points.element[last] == points.element[first]) ++last;
    const auto element = static_cast<std::size_t>(points.element[first]);
    const auto near = neighbours(snapshot, around, element);
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    for (const std::int64_t id : near) {
      const auto& centre = centres[static_cast<std::size_t>(id)];
      const Eigen::Vector2d apart(centre[0] - centres[element][0], centre[1] - centres[element][1]);
      normal += apart * apart.transpose();
    }
    // Neighbours in one row only leave the gradient across the row undetermined; the pseudo-inverse sets it to zero.
    const Eigen::Matrix2d inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
    for (std::size_t k = 0; k < columns; ++k) {
      const double mean = field[columns * element + k];
      double low = mean, high = mean;
      Eigen::Vector2d right = Eigen::Vector2d::Zero();
      for (const std::int64_t id : near) {
        const auto other = static_cast<std::size_t>(id);
        const double value = field[columns * other + k];
        low = std::min(low, value);
        high = std::max(high, value);
        right += (value - mean) *
                 Eigen::Vector2d(centres[other][0] - centres[element][0], centres[other][1] - centres[element][1]);
      }
      if (on_edge[element]) {
        const double reach = std::max(high - mean, mean - low);
        low = mean - reach;
        high = mean + reach;
      }
      const Eigen::Vector2d gradient = inverse * right;
      double limiter = 1.0;
      const auto change = [&](std::size_t p) {
        return gradient[0] * (points.initial_position[2 * p] - centres[element][0]) +
               gradient[1] * (points.initial_position[2 * p + 1] - centres[element][1]);
      };
      for (std::size_t p = first; p < last; ++p) {
        const double step = change(p), room = step > 0.0 ? high - mean : low - mean;
        if (std::abs(step) > std::abs(room)) limiter = std::min(limiter, room / step);
      }
      for (std::size_t p = first; p < last; ++p) values[columns * p + k] = mean + limiter * change(p);
    }
  }
  return values;
}

}  // namespace tailrun::transfer

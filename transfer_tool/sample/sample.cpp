#include "transfer_tool/sample/sample.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

// One point of an element: integral weights of its cell, mass-averaged shape functions, initial and deformed areas.
struct Cell {
  NodeWeights node_weights{};
  double initial_area = 0.0;   // m2
  double deformed_area = 0.0;  // m2
};

double mid_line(const Corners& c, std::size_t a, std::size_t b, std::size_t d, std::size_t e) {
  return 0.5 * std::hypot(c[a][0] + c[b][0] - c[d][0] - c[e][0], c[a][1] + c[b][1] - c[d][1] - c[e][1]);
}

Cell gauss_point(const Corners& initial, const Corners& deformed, int n, int i, int j) {
  const GaussRule& rule = gauss_rule(n);
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
  const double xi = rule.abscissa[a], eta = rule.abscissa[b], weight = rule.weight[a] * rule.weight[b];
  return {shape_functions(xi, eta), weight * jacobian(initial, xi, eta), weight * jacobian(deformed, xi, eta)};
}

// The 2 x 2 rule is exact for N_a J, of degree 2 in each direction.
Cell uniform_cell(const Corners& initial, const Corners& deformed, std::array<int, 2> n, int i, int j) {
  const GaussRule& rule = gauss_rule(2);
  Cell cell;
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t b = 0; b < 2; ++b) {
      const double xi = (2.0 * i + 1.0 + rule.abscissa[a]) / n[0] - 1.0;
      const double eta = (2.0 * j + 1.0 + rule.abscissa[b]) / n[1] - 1.0;
      const double weight = 1.0 / (static_cast<double>(n[0]) * n[1]);
      const double initial_area = weight * jacobian(initial, xi, eta);
      const NodeWeights values = shape_functions(xi, eta);
      for (std::size_t k = 0; k < 4; ++k) cell.node_weights[k] += values[k] * initial_area;
      cell.initial_area += initial_area;
      cell.deformed_area += weight * jacobian(deformed, xi, eta);
    }
  for (double& weight : cell.node_weights) weight /= cell.initial_area;
  return cell;
}

std::string named(const Snapshot& snapshot, std::size_t element) {
  const auto [x, y] = centre(initial_corners(snapshot, element));
  return fmt::format("element {} of region '{}' near ({:.2f}, {:.2f})", element,
                     snapshot.region_names[static_cast<std::size_t>(snapshot.region_id[element])], x, y);
}

}  // namespace

std::vector<bool> kept_elements(const Snapshot& snapshot, const SamplingOptions& options) {
  std::vector<bool> kept(snapshot.elements(), false);
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    const auto [x, y] = centre(initial_corners(snapshot, e));
    kept[e] = options.kept_region[static_cast<std::size_t>(snapshot.region_id[e])] && x >= options.clip_x[0] &&
              x <= options.clip_x[1] && y >= options.clip_y[0] && y <= options.clip_y[1];
  }
  return kept;
}

std::array<double, 2> points_in_element(const Corners& deformed, const SamplingOptions& options, std::size_t region) {
  if (const double wanted = options.points[region]; wanted > 0.0) return {wanted, wanted};
  const double spacing = options.cell_size / std::sqrt(options.points_per_cell);
  const auto count = [&](double length) { return std::max(1.0, std::round(length / spacing)); };
  std::array<double, 2> n = {count(mid_line(deformed, 1, 2, 0, 3)), count(mid_line(deformed, 2, 3, 0, 1))};
  // A Gauss rule with different counts along xi and eta needs two rules; the larger count serves both directions.
  if (options.layout == Layout::gauss) n[0] = n[1] = std::min(5.0, std::max(n[0], n[1]));
  return n;
}

SamplePoints sample(const Snapshot& snapshot, const std::vector<bool>& kept, const SamplingOptions& options) {
  SamplePoints points;
  const double spacing = options.cell_size / std::sqrt(options.points_per_cell);
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    if (!kept[e]) continue;
    const Corners initial = initial_corners(snapshot, e), deformed = deformed_corners(snapshot, e);
    const auto region = static_cast<std::size_t>(snapshot.region_id[e]);
    const auto asked = points_in_element(deformed, options, region);
    const std::array<int, 2> n = {static_cast<int>(asked[0]), static_cast<int>(asked[1])};
    const bool is_gauss = options.layout == Layout::gauss && std::max(n[0], n[1]) > 1;
    if (is_gauss && options.points[region] == 0) {
      const double longest = std::max(mid_line(deformed, 1, 2, 0, 3), mid_line(deformed, 2, 3, 0, 1));
      if (longest / spacing > 5.5) ++points.capped_elements;
    }
    points.largest_count = std::max<long>(points.largest_count, std::max(n[0], n[1]));

    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j) {
        Cell cell = is_gauss ? gauss_point(initial, deformed, n[0], i, j) : uniform_cell(initial, deformed, n, i, j);
        if (!(cell.initial_area > 0.0))
          throw InputError(fmt::format("{} is folded in the undeformed mesh; mend the mesh", named(snapshot, e)));
        if (!(cell.deformed_area > 0.0)) {
          if (options.inverted == InvertedElements::error)
            throw InputError(
                fmt::format("{} is inverted at t = {:g} s (scaled Jacobian {:.3f}); take an earlier snapshot, or set "
                            "/sampling/inverted_elements to \"initial_volume\"",
                            named(snapshot, e), snapshot.time, scaled_jacobian(deformed)));
          cell.deformed_area = cell.initial_area;
        }
        points.element.push_back(static_cast<std::int64_t>(e));
        points.mass.push_back(snapshot.density[e] * cell.initial_area);
        points.volume.push_back(cell.deformed_area);
        for (const double weight : cell.node_weights) points.node_weights.push_back(weight);
        for (std::size_t k = 0; k < 2; ++k) {
          double before = 0.0, after = 0.0;
          for (std::size_t a = 0; a < 4; ++a) {
            before += cell.node_weights[a] * initial[a][k];
            after += cell.node_weights[a] * deformed[a][k];
          }
          points.initial_position.push_back(before);
          points.position.push_back(after);
        }
      }
  }
  if (points.count() == 0)
    throw InputError(
        "/exclude: no element is left to become particles: every region is excluded, part of the bed "
        "(/terrain/regions) "
        "or outside of /clip");
  return points;
}

}  // namespace tailrun::transfer

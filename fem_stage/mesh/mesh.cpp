#include "fem_stage/mesh/mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/error.hpp"
#include "common/plain_names.hpp"

namespace tailrun::fem {
namespace {

double distance2(double ax, double ay, double bx, double by) {
  return (ax - bx) * (ax - bx) + (ay - by) * (ay - by);
}

std::vector<std::string> names_of(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const auto& [name, edges] : mesh.lines) names.push_back(name);
  return names;
}

using Edge = std::array<std::int64_t, 2>;

Edge undirected(std::int64_t a, std::int64_t b) {
  return a < b ? Edge{a, b} : Edge{b, a};
}

std::map<Edge, int> edge_use(const Mesh& mesh) {
  std::map<Edge, int> use;
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (int a = 0; a < 4; ++a) ++use[undirected(mesh.quads[4 * e + a], mesh.quads[4 * e + (a + 1) % 4])];
  return use;
}

void corners_of(const Mesh& mesh, const std::vector<double>& displacement, std::size_t e, double corners[8]) {
  for (int a = 0; a < 4; ++a) {
    const std::size_t node = static_cast<std::size_t>(mesh.quads[4 * e + a]);
    for (std::size_t i = 0; i < 2; ++i)
      corners[2 * a + i] = mesh.position[2 * node + i] + (displacement.empty() ? 0.0 : displacement[2 * node + i]);
  }
}

}  // namespace

std::vector<std::int64_t> Mesh::nodes_of_line(const std::string& name) const {
  const auto it = lines.find(name);
  if (it == lines.end())
    throw InputError(fmt::format("the mesh has no physical curve '{}'.{} It has: {}", name,
                                 did_you_mean(name, names_of(*this)), joined(names_of(*this))));
  std::set<std::int64_t> unique;
  for (const auto& edge : it->second) unique.insert(edge.begin(), edge.end());
  return {unique.begin(), unique.end()};
}

std::array<double, 2> Mesh::centre(std::size_t element) const {
  std::array<double, 2> sum{};
  for (int a = 0; a < 4; ++a)
    for (std::size_t i = 0; i < 2; ++i)
      sum[i] += 0.25 * position[2 * static_cast<std::size_t>(quads[4 * element + a]) + i];
  return sum;
}

std::size_t Mesh::nearest_node(double px, double py) const {
  std::size_t best = 0;
  for (std::size_t n = 1; n < nodes(); ++n)
    if (distance2(x(n), y(n), px, py) < distance2(x(best), y(best), px, py)) best = n;
  return best;
}

std::size_t Mesh::nearest_element(double px, double py) const {
  std::size_t best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < elements(); ++e) {
    const auto c = centre(e);
    const double d = distance2(c[0], c[1], px, py);
    if (d < best_distance) {
      best = e;
      best_distance = d;
    }
  }
  return best;
}

void check_mesh(Mesh& mesh, const std::string& source) {
  if (mesh.elements() == 0)
    throw InputError(fmt::format("{}: the mesh has no quadrilaterals in any physical surface", source));
  for (const auto& [name, edges] : mesh.lines)
    if (const std::string fault = fault_as_dataset(name); !fault.empty())
      throw InputError(
          fmt::format("{}: the name {} of a physical curve {}, but it is a dataset's name in snapshots; give "
                      "it another in the geometry",
                      source, shown_name(name), fault));
  std::vector<char> used(mesh.nodes(), 0);
  std::set<std::array<std::int64_t, 4>> shapes;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    double corners[8];
    corners_of(mesh, {}, e, corners);
    double area = 0.0;
    for (int a = 0; a < 4; ++a) {
      const int b = (a + 1) % 4;
      area += 0.5 * (corners[2 * a] * corners[2 * b + 1] - corners[2 * b] * corners[2 * a + 1]);
    }
    if (area < 0.0) {
      std::swap(mesh.quads[4 * e + 1], mesh.quads[4 * e + 3]);
      corners_of(mesh, {}, e, corners);
    }
    if (scaled_jacobian(corners) <= 0.0) {
      const auto c = mesh.centre(e);
      throw InputError(
          fmt::format("{}: element {} of region '{}' at ({:.3g}, {:.3g}) is degenerate or not convex; mend the "
                      "geometry or its mesh sizes there",
                      source, e, mesh.region_names[static_cast<std::size_t>(mesh.region[e])], c[0], c[1]));
    }
    std::array<std::int64_t, 4> shape;
    for (std::size_t a = 0; a < 4; ++a) shape[a] = mesh.quads[4 * e + a];
    for (const auto node : shape) used[static_cast<std::size_t>(node)] = 1;
    std::sort(shape.begin(), shape.end());
    if (!shapes.insert(shape).second)
      throw InputError(
          fmt::format("{}: the element at ({:.4g}, {:.4g}) is there twice; it would be twice as stiff and heavy",
                      source, mesh.centre(e)[0], mesh.centre(e)[1]));
  }
  for (std::size_t n = 0; n < mesh.nodes(); ++n)
    if (!used[n])
      throw InputError(
          fmt::format("{}: node {} at ({:.3g}, {:.3g}) belongs to no element", source, n, mesh.x(n), mesh.y(n)));

  std::set<Edge> named;
  for (const auto& [name, edges] : mesh.lines)
    for (const auto& edge : edges) named.insert(undirected(edge[0], edge[1]));
  for (const auto& [edge, count] : edge_use(mesh)) {
    const auto a = static_cast<std::size_t>(edge[0]), b = static_cast<std::size_t>(edge[1]);
    const double cx = 0.5 * (mesh.x(a) + mesh.x(b)), cy = 0.5 * (mesh.y(a) + mesh.y(b));
    if (count > 2)
      throw InputError(fmt::format("{}: {} elements share the edge at ({:.4g}, {:.4g})", source, count, cx, cy));
    if (count == 1 && !named.contains(edge))
      throw InputError(
          fmt::format("{}: the boundary edge at ({:.4g}, {:.4g}) belongs to no physical curve. Either a surface next "
                      "to it was left out of the physical "
                      "groups (a hole in the mesh), neighbouring surfaces do not share their nodes, or the outer "
                      "boundary needs a physical curve there. Named: {}",
                      source, cx, cy, joined(names_of(mesh))));
  }
}

double scaled_jacobian(const double c[8]) {
  double worst = 1.0;
  for (int a = 0; a < 4; ++a) {
    const int b = (a + 1) % 4, d = (a + 3) % 4;
    const double ux = c[2 * b] - c[2 * a], uy = c[2 * b + 1] - c[2 * a + 1];
    const double vx = c[2 * d] - c[2 * a], vy = c[2 * d + 1] - c[2 * a + 1];
    const double lengths = std::sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy));
    worst = std::min(worst, lengths > 0.0 ? (ux * vy - uy * vx) / lengths : 0.0);
  }
  return worst;
}

std::vector<double> scaled_jacobians(const Mesh& mesh, const std::vector<double>& displacement) {
  std::vector<double> values(mesh.elements());
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    double corners[8];
    corners_of(mesh, displacement, e, corners);
    values[e] = scaled_jacobian(corners);
  }
  return values;
}

double ground_elevation(const Mesh& mesh, double x) {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    for (int a = 0; a < 4; ++a) {
      const auto p = static_cast<std::size_t>(mesh.quads[4 * e + a]),
                 q = static_cast<std::size_t>(mesh.quads[4 * e + (a + 1) % 4]);
      const double low = std::min(mesh.x(p), mesh.x(q)), high = std::max(mesh.x(p), mesh.x(q));
      if (x < low || x > high) continue;
      const double s = high > low ? (x - mesh.x(p)) / (mesh.x(q) - mesh.x(p)) : 0.0;
      top = std::max(top, high > low ? mesh.y(p) + s * (mesh.y(q) - mesh.y(p)) : std::max(mesh.y(p), mesh.y(q)));
    }
  }
  if (!std::isfinite(top)) throw InputError(fmt::format("the mesh has no ground at x = {:g} m", x));
  return top;
}

}  // namespace tailrun::fem

#include "fem_stage/boundary/nodal_loads.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.hpp"

namespace tailrun::fem {

std::vector<BoundaryEdge> boundary_edges(const Mesh& mesh, std::span<const double> thickness, const std::string& line,
                                         const std::string& where) {
  const auto it = mesh.lines.find(line);
  if (it == mesh.lines.end()) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : mesh.lines) names.push_back(name);
    throw InputError(fmt::format("{}: the mesh has no physical curve '{}'.{} It has: {}", where, line,
                                 did_you_mean(line, names), joined(names)));
  }
  struct Owner {
    int count = 0;
    std::size_t element = 0;
    bool forward = true;  // the element runs through the edge from the smaller node to the larger
  };
  std::map<std::array<std::int64_t, 2>, Owner> owners;
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = mesh.quads[4 * e + a], q = mesh.quads[4 * e + (a + 1) % 4];
      Owner& owner = owners[{std::min(p, q), std::max(p, q)}];
      ++owner.count;
      owner.element = e;
      owner.forward = p < q;
    }
  std::vector<BoundaryEdge> edges;
  for (const auto& [p, q] : it->second) {
    const auto found = owners.find({std::min(p, q), std::max(p, q)});
    if (found == owners.end())
      throw InputError(fmt::format("{}: an edge of line '{}' at ({:.4g}, {:.4g}) is no side of an element", where, line,
                                   mesh.x(static_cast<std::size_t>(p)), mesh.y(static_cast<std::size_t>(p))));
    const Owner& owner = found->second;
    if (owner.count != 1)
      throw InputError(
          fmt::format("{}: line '{}' runs inside the model (between two elements at ({:.4g}, {:.4g})), but "
                      "a line on its outline is required",
                      where, line, mesh.x(static_cast<std::size_t>(p)), mesh.y(static_cast<std::size_t>(p))));
    // Elements are counter-clockwise: the outside is to the right of the way from a to b.
    const auto a = owner.forward ? std::min(p, q) : std::max(p, q), b = owner.forward ? std::max(p, q) : std::min(p, q);
    const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
    const double dx = mesh.x(ib) - mesh.x(ia), dy = mesh.y(ib) - mesh.y(ia), length = std::hypot(dx, dy);
    edges.push_back({a, b, length, thickness[owner.element], {dy / length, -dx / length}});
  }
  return edges;
}

std::vector<NodalForce> line_forces(std::span<const BoundaryEdge> edges, std::array<double, 2> traction,
                                    double pressure) {
  std::vector<NodalForce> forces;
  for (const auto& edge : edges) {
    const double half = 0.5 * edge.length * edge.thickness;
    const double x = half * (traction[0] - pressure * edge.normal[0]),
                 y = half * (traction[1] - pressure * edge.normal[1]);
    forces.push_back({edge.a, x, y});
    forces.push_back({edge.b, x, y});
  }
  return forces;
}

std::vector<NodalForce> pond_forces(const Mesh& mesh, std::span<const BoundaryEdge> edges, double level,
                                    double weight) {
  std::vector<NodalForce> forces;
  for (const auto& edge : edges) {
    const double ya = mesh.y(static_cast<std::size_t>(edge.a)), yb = mesh.y(static_cast<std::size_t>(edge.b));
    // The wetted part, s in [s0, s1] from a to b.
    double s0 = 0.0, s1 = 1.0;
    if (ya >= level && yb >= level) continue;
    if (ya > level) s0 = (level - ya) / (yb - ya);
    if (yb > level) s1 = (level - ya) / (yb - ya);
    const double area = (s1 - s0) * edge.length * edge.thickness, gauss = 0.5 / std::sqrt(3.0);
    double at_a = 0.0, at_b = 0.0;  // two points are exact for pressure times shape function
    for (const double g : {0.5 - gauss, 0.5 + gauss}) {
      const double s = s0 + g * (s1 - s0), pressure = weight * (level - (ya + s * (yb - ya)));
      at_a += 0.5 * area * pressure * (1.0 - s);
      at_b += 0.5 * area * pressure * s;
    }
    forces.push_back({edge.a, -at_a * edge.normal[0], -at_a * edge.normal[1]});
    forces.push_back({edge.b, -at_b * edge.normal[0], -at_b * edge.normal[1]});
  }
  return forces;
}

void add_load(const NodalLoad& load, double time, std::span<double> force) {
  const double factor = load.history.at(time);
  for (const auto& f : load.forces) {
    force[2 * static_cast<std::size_t>(f.node)] += factor * f.x;
    force[2 * static_cast<std::size_t>(f.node) + 1] += factor * f.y;
  }
}

}  // namespace tailrun::fem

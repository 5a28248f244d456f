#include "fem_stage/model/output_places.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

double longest_side(const Mesh& mesh, std::size_t element) {
  double longest = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    const auto p = static_cast<std::size_t>(mesh.quads[4 * element + a]),
               q = static_cast<std::size_t>(mesh.quads[4 * element + (a + 1) % 4]);
    longest = std::max(longest, std::hypot(mesh.x(p) - mesh.x(q), mesh.y(p) - mesh.y(q)));
  }
  return longest;
}

// Distance (m) of a place from an element, 0 inside.
double distance_to(const Mesh& mesh, std::size_t element, double x, double y) {
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 4; ++a) {
    const auto p = static_cast<std::size_t>(mesh.quads[4 * element + a]),
               q = static_cast<std::size_t>(mesh.quads[4 * element + (a + 1) % 4]);
    const double dx = mesh.x(q) - mesh.x(p), dy = mesh.y(q) - mesh.y(p), px = x - mesh.x(p), py = y - mesh.y(p);
    inside = inside && dx * py - dy * px >= 0.0;
    const double s = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    nearest = std::min(nearest, std::hypot(px - s * dx, py - s * dy));
  }
  return inside ? 0.0 : nearest;
}

void check_place(const Mesh& mesh, const NamedPoint& place, const char* key) {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t e = 0; e < mesh.elements() && distance > 0.0; ++e)
    if (const double d = distance_to(mesh, e, place.x, place.y); d < distance) {
      distance = d;
      nearest = e;
    }
  const double allowed = longest_side(mesh, nearest);
  if (distance <= allowed) return;
  const std::size_t node = mesh.nearest_node(place.x, place.y);
  throw InputError(
      fmt::format("/output/{}/{}: ({:.6g}, {:.6g}) is {:.4g} m off the mesh, but at most one element ({:.3g} m there) "
                  "is allowed; the "
                  "nearest node is at ({:.6g}, {:.6g})",
                  key, place.name, place.x, place.y, distance, allowed, mesh.x(node), mesh.y(node)));
}

}  // namespace

void check_output_places(const Mesh& mesh, const FemCase& options) {
  for (const auto& point : options.output.points) check_place(mesh, point, "points");
  for (const auto& element : options.output.elements) check_place(mesh, element, "elements");
  liquefaction_elements(mesh, options.output);
}

std::vector<std::size_t> liquefaction_elements(const Mesh& mesh, const OutputOptions& output) {
  std::vector<std::size_t> elements;
  if (output.liquefaction_region.empty()) return elements;
  const auto it = std::find(mesh.region_names.begin(), mesh.region_names.end(), output.liquefaction_region);
  if (it == mesh.region_names.end())
    throw InputError(fmt::format(
        "/output/liquefaction/region: the mesh has no region '{}'.{} It has: {}", output.liquefaction_region,
        did_you_mean(output.liquefaction_region, mesh.region_names), joined(mesh.region_names)));
  const auto id = static_cast<std::int32_t>(it - mesh.region_names.begin());
  const auto& window = output.liquefaction_window;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    if (mesh.region[e] != id) continue;
    const double x = mesh.centre(e)[0];
    low = std::min(low, x);
    high = std::max(high, x);
    if (x >= window[0] && x <= window[1]) elements.push_back(e);
  }
  if (elements.empty() || !(window[0] < window[1]))
    throw InputError(
        fmt::format("/output/liquefaction/window: found [{:g}, {:g}] m, but no element of region '{}' has "
                    "its centre in it; they lie from x = {:.4g} to {:.4g} m",
                    window[0], window[1], output.liquefaction_region, low, high));
  return elements;
}

}  // namespace tailrun::fem

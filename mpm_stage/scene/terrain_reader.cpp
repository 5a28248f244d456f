// "terrain" of mpm.json: lines given here or carried in the particles file, with friction by segment.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/scene/line_crossing.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// "friction": one number, a list with one per segment, or "friction_regions": [[x_from, x_to, mu], ...] over a
// "friction" that holds elsewhere; a segment belongs to the region of its middle.
std::vector<double> segment_friction(const CaseNode& node, const TerrainInput& line) {
  const std::size_t segments = line.points.size() - 1;
  std::vector<double> friction;
  if (node.is_list("friction"))
    friction = node.numbers("friction", "1", Range::non_negative(), segments);
  else
    friction.assign(segments, node.number("friction", "1", Range::non_negative()));
  const auto regions =
      node.has("friction_regions") ? node.table("friction_regions", "m, m, 1", 3) : std::vector<double>{};
  for (std::size_t r = 0; r < regions.size(); r += 3)
    for (std::size_t s = 0; s < segments; ++s) {
      const double middle = 0.5 * (line.points[s][0] + line.points[s + 1][0]);
      if (middle >= regions[r] && middle < regions[r + 1]) friction[s] = regions[r + 2];
    }
  constexpr double degrees_from = 10.0;  // a ground that holds what lies on it has 1
  const double largest = *std::max_element(friction.begin(), friction.end());
  if (largest > degrees_from && largest < 90.0)
    node.warn("friction", fmt::format("{:g} on '{}' is a coefficient, not an angle; were it meant in degrees, it would "
                                      "be {:.3g}",
                                      largest, line.name, std::tan(largest * M_PI / 180.0)));
  return friction;
}

}  // namespace

std::vector<TerrainInput> read_terrain(const CaseNode& root, const ParticleSet& particles) {
  std::vector<TerrainInput> lines;
  for (const CaseNode& node : root.list_or_empty("terrain")) {
    TerrainInput line;
    line.name = node.text_or("name", fmt::format("terrain_{}", lines.size()));
    std::vector<double> points;
    if (node.has("points")) {
      points = node.table("points", "m", 2);
    } else {
      const std::string wanted = node.text("from_particles");
      std::vector<std::string> names;
      for (const auto& t : particles.terrain) {
        names.push_back(t.name);
        if (t.name == wanted) points = t.points;
      }
      if (points.empty())
        node.fail("from_particles", fmt::format("the particles file has no terrain line '{}' (it has: {}).{}", wanted,
                                                names.empty() ? "none" : joined(names), did_you_mean(wanted, names)));
      line.name = wanted;
    }
    if (points.size() < 4) node.fail("points", "needs at least 2 points");
    for (std::size_t i = 0; i < points.size(); i += 2) line.points.push_back({points[i], points[i + 1]});
    for (std::size_t i = 1; i < line.points.size(); ++i)
      if (line.points[i] == line.points[i - 1])
        node.fail("points", fmt::format("points {} and {} are the same", i - 1, i));
    if (const auto crossing = first_crossing(line.points))
      node.fail(
          node.has("points") ? "points" : "from_particles",
          fmt::format("the line crosses or touches itself at ({:.6g}, {:.6g}) m: segment {} (points {} and {}) and "
                      "segment {} (points {} and {}); material lies on the left of a line, which is then not told",
                      crossing->place[0], crossing->place[1], crossing->first, crossing->first, crossing->first + 1,
                      crossing->second, crossing->second, crossing->second + 1));
    line.friction = segment_friction(node, line);
    line.adhere = node.boolean_or("adhere", false);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace tailrun::mpm

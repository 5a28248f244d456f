// "terrain" of mpm.json: lines given here or carried in the particles file, with friction by segment.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/line_crossing.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// "friction_regions" of a line: rows [x_from, x_to, mu].
struct FrictionRegion {
  double from, to, friction;  // m, m, 1
};

std::vector<FrictionRegion> read_regions(const CaseNode& node) {
  std::vector<FrictionRegion> regions;
  if (!node.has("friction_regions")) return regions;
  const auto rows = node.table("friction_regions", "m, m, 1", 3);
  for (std::size_t r = 0; r < rows.size(); r += 3) {
    const FrictionRegion region{rows[r], rows[r + 1], rows[r + 2]};
    const std::string key = fmt::format("friction_regions/{}", r / 3);
    if (!(region.from < region.to))
      node.fail(key, fmt::format("goes from {:g} to {:g} m: the first number must be below the second", region.from,
                                 region.to));
    if (!(region.friction >= 0.0))
      node.fail(key, fmt::format("found a friction of {:g}, but allowed is [0, inf)", region.friction));
    for (std::size_t o = 0; o < regions.size(); ++o)
      if (const double low = std::max(region.from, regions[o].from), high = std::min(region.to, regions[o].to);
          low < high)
        node.fail(key, fmt::format("holds x from {:g} to {:g} m, which region {} does, too, with a friction of {:g} "
                                   "beside {:g}; set them apart",
                                   low, high, o, regions[o].friction, region.friction));
    regions.push_back(region);
  }
  return regions;
}

// "friction": one number, a list with one per segment, or "friction_regions" over a "friction" that holds elsewhere; a
// segment belongs to the region of its middle.
std::vector<double> segment_friction(const CaseNode& node, const TerrainInput& line) {
  const std::size_t segments = line.points.size() - 1;
  const std::string name = fmt::format("'{}'", line.name);
  std::vector<double> friction;
  if (node.is_list("friction"))
    friction = node.numbers("friction", "1", Range::non_negative(), segments);
  else
    friction.assign(segments, node.number("friction", "1", Range::non_negative()));
  check_friction(node, "friction", *std::max_element(friction.begin(), friction.end()), name);
  const auto regions = read_regions(node);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const std::string key = fmt::format("friction_regions/{}", r);
    double first = 0.0, last = 0.0;
    bool any = false;
    for (std::size_t s = 0; s < segments; ++s) {
      const double middle = 0.5 * (line.points[s][0] + line.points[s + 1][0]);
      first = s == 0 ? middle : std::min(first, middle);
      last = s == 0 ? middle : std::max(last, middle);
      if (!(middle >= regions[r].from && middle < regions[r].to)) continue;
      friction[s] = regions[r].friction;
      any = true;
    }
    if (!any)
      node.warn(key,
                fmt::format("x from {:g} to {:g} m holds the middle of no segment of {}, so its friction of {:g} is "
                            "nowhere; the middles of its {} segments lie from {:g} to {:g} m",
                            regions[r].from, regions[r].to, name, regions[r].friction, segments, first, last));
    check_friction(node, key, regions[r].friction, name);
  }
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

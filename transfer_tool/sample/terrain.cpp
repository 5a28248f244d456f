#include "transfer_tool/sample/terrain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/error.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

constexpr double least_upward = 0.1;  // sine of the angle by which a free surface must face up

using NextNode = std::map<std::int64_t, std::int64_t>;

// Directed sides with the bed on their right: an element has its interior on the left of its own sides.
NextNode bed_sides(const Snapshot& snapshot, const std::vector<bool>& kept, const std::vector<bool>& is_bed) {
  NextNode next;
  const auto in_bed = [&](std::int64_t element) {
    return is_bed[static_cast<std::size_t>(snapshot.region_id[static_cast<std::size_t>(element)])];
  };
  for (const auto& side : element_sides(snapshot)) {
    if (!in_bed(side.element) || (side.neighbour >= 0 && in_bed(side.neighbour))) continue;
    const auto from = static_cast<std::size_t>(side.to), to = static_cast<std::size_t>(side.from);
    const double dx = snapshot.position[2 * to] - snapshot.position[2 * from];
    const double dy = snapshot.position[2 * to + 1] - snapshot.position[2 * from + 1];
    const bool under_kept = side.neighbour >= 0 && kept[static_cast<std::size_t>(side.neighbour)];
    if (!under_kept && dx < least_upward * std::hypot(dx, dy)) continue;
    if (!next.emplace(side.to, side.from).second)
      throw InputError(fmt::format("/terrain/regions: the bed's surface branches at node {} ({:g}, {:g})", side.to,
                                   snapshot.position[2 * from], snapshot.position[2 * from + 1]));
  }
  return next;
}

// Sides of kept elements behind which the mesh goes on without being kept: neither bed nor the open air.
NextNode cut_sides(const Snapshot& snapshot, const std::vector<bool>& kept, const std::vector<bool>& is_bed) {
  NextNode next;
  for (const auto& side : element_sides(snapshot)) {
    if (!kept[static_cast<std::size_t>(side.element)] || side.neighbour < 0) continue;
    const auto other = static_cast<std::size_t>(side.neighbour);
    if (!kept[other] && !is_bed[static_cast<std::size_t>(snapshot.region_id[other])]) next[side.from] = side.to;
  }
  return next;
}

// Points of the deformed geometry, one list per chain, each from a node that no side leads to.
std::vector<std::vector<double>> chained(const Snapshot& snapshot, NextNode next) {
  std::set<std::int64_t> targets;
  for (const auto& [from, to] : next) targets.insert(to);
  std::vector<std::vector<double>> chains;
  while (!next.empty()) {
    auto start =
        std::find_if(next.begin(), next.end(), [&](const auto& side) { return !targets.contains(side.first); });
    if (start == next.end()) start = next.begin();  // a closed loop, e.g. a bed that is an island
    std::vector<double> points;
    const auto add = [&](std::int64_t id) {
      const auto node = static_cast<std::size_t>(id);
      for (std::size_t k = 0; k < 2; ++k)
        points.push_back(snapshot.position[2 * node + k] + snapshot.displacement[2 * node + k]);
    };
    std::int64_t node = start->first;
    add(node);
    for (auto it = next.find(node); it != next.end(); it = next.find(node)) {
      node = it->second;
      next.erase(it);
      add(node);
    }
    chains.push_back(std::move(points));
  }
  std::sort(chains.begin(), chains.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
  return chains;
}

}  // namespace

bool TerrainOptions::any() const {
  return std::find(region.begin(), region.end(), true) != region.end();
}

std::vector<TerrainLine> wall_lines(const Snapshot& snapshot, const std::vector<bool>& kept,
                                    const TerrainOptions& options) {
  std::vector<TerrainLine> lines;
  int upstream = 0, downstream = 0;
  for (auto& points : chained(snapshot, cut_sides(snapshot, kept, options.region))) {
    // Kept material on the left: an upstream cut is walked down, a downstream one up. The upper end goes on upwards, so
    // that what heaves does not spill over.
    const bool is_upstream = points[1] > points[points.size() - 1];
    if (is_upstream)
      points.insert(points.begin(), {points[0], points[1] + options.wall_height});
    else
      points.insert(points.end(), {points[points.size() - 2], points[points.size() - 1] + options.wall_height});
    const std::string name = is_upstream ? "upstream_wall" : "downstream_wall";
    const int number = is_upstream ? ++upstream : ++downstream;
    lines.push_back({number == 1 ? name : fmt::format("{}_{}", name, number), std::move(points)});
  }
  return lines;
}

std::vector<TerrainLine> terrain_lines(const Snapshot& snapshot, const std::vector<bool>& kept,
                                       const TerrainOptions& options) {
  const NextNode sides = bed_sides(snapshot, kept, options.region);
  if (sides.empty())
    throw InputError("/terrain/regions: the named regions have no surface towards kept elements or the open air");
  std::vector<TerrainLine> lines;
  for (auto& points : chained(snapshot, sides))
    lines.push_back(
        {lines.empty() ? options.name : fmt::format("{}_{}", options.name, lines.size() + 1), std::move(points)});

  if (options.extend) {
    auto& points = lines.back().points;
    const double x = points[points.size() - 2], y = points.back();
    if (options.downstream_to <= x)
      throw InputError(fmt::format("/terrain/downstream_to: found {:g} m, but the mesh's ground already reaches {:g} m",
                                   options.downstream_to, x));
    const double fall = std::tan(options.downstream_slope * std::numbers::pi / 180.0) * (options.downstream_to - x);
    points.insert(points.end(), {options.downstream_to, y - fall});
  }
  return lines;
}

}  // namespace tailrun::transfer

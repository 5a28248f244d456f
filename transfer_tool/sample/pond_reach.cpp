#include "transfer_tool/sample/pond_reach.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

constexpr double noticed = 0.1, refused = 1.0;  // m of water that nothing weighs

struct Point {
  double x, y;  // m
};

Point place(const Snapshot& snapshot, std::int64_t node, bool deformed) {
  const auto n = static_cast<std::size_t>(node);
  const double share = deformed ? 1.0 : 0.0;
  return {snapshot.position[2 * n] + share * snapshot.displacement[2 * n],
          snapshot.position[2 * n + 1] + share * snapshot.displacement[2 * n + 1]};
}

// The ground's surface by x: at each end of a side of the outline that faces up, the height of the highest of them.
std::vector<Point> surface_profile(const Snapshot& snapshot) {
  std::vector<std::pair<Point, Point>> sides;
  std::set<double> places;
  for (const auto& side : element_sides(snapshot)) {
    if (side.neighbour >= 0) continue;
    const Point a = place(snapshot, side.to, true), b = place(snapshot, side.from, true);
    if (!(b.x > a.x)) continue;  // the element on the left of its sides: upper ones run towards smaller x
    sides.emplace_back(a, b);
    places.insert({a.x, b.x});
  }
  std::vector<Point> profile;
  for (const double x : places) {
    double y = -std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : sides)
      if (x >= a.x && x <= b.x) y = std::max(y, a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x));
    profile.push_back({x, y});
  }
  return profile;
}

// From the profile's point `at` on in steps of +1 or -1. Returns false when the ground stays below the level.
bool find_divide(const std::vector<Point>& profile, std::ptrdiff_t at, int step, double level, double& x) {
  const auto inside = [&](std::ptrdiff_t k) { return k >= 0 && k < static_cast<std::ptrdiff_t>(profile.size()); };
  const auto point = [&](std::ptrdiff_t k) { return profile[static_cast<std::size_t>(k)]; };
  while (inside(at) && point(at).y < level) at += step;
  if (!inside(at)) return false;
  double highest = point(at).y;
  for (x = point(at).x; inside(at) && point(at).y >= level; at += step)
    if (point(at).y > highest) {
      highest = point(at).y;
      x = point(at).x;
    }
  return true;
}

double height_of(const std::vector<double>& line, double x) {
  if (x <= line[0]) return line[1];
  for (std::size_t k = 2; k + 1 < line.size(); k += 2)
    if (x <= line[k])
      return line[k - 1] + (line[k + 1] - line[k - 1]) * (x - line[k - 2]) / std::max(line[k] - line[k - 2], 1e-300);
  return line.back();
}

}  // namespace

std::vector<PondedReach> pond_reaches(const Snapshot& snapshot) {
  std::vector<PondedReach> reaches;
  if (snapshot.ponds.empty()) return reaches;
  const std::vector<Point> profile = surface_profile(snapshot);
  for (const PondedLines& pond : snapshot.ponds) {
    PondedReach reach{
        fmt::format("{}", fmt::join(pond.lines, "|")), pond.level, {}, {true, true}, snapshot.fluid_density};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& line : snapshot.lines) {
      if (std::find(pond.lines.begin(), pond.lines.end(), line.name) == pond.lines.end()) continue;
      for (const std::int64_t node : line.edges)
        if (const Point p = place(snapshot, node, true); p.y < pond.level) {
          low = std::min(low, p.x);
          high = std::max(high, p.x);
        }
    }
    if (!(high >= low)) {
      add_warning(fmt::format("pond '{}': nothing of its lines lies below its level of {:g} m; it is left out",
                              reach.name, pond.level));
      continue;
    }
    const auto at = [&](double x) {
      return std::lower_bound(profile.begin(), profile.end(), x, [](const Point& p, double v) { return p.x < v; }) -
             profile.begin();
    };
    reach.extent = {profile.front().x, profile.back().x};
    reach.endless[0] = !find_divide(profile, std::min<std::ptrdiff_t>(at(low), std::ssize(profile) - 1), -1, pond.level,
                                    reach.extent[0]);
    reach.endless[1] = !find_divide(profile, at(high), 1, pond.level, reach.extent[1]);
    reaches.push_back(std::move(reach));
  }
  return reaches;
}

void check_standing_water(const Snapshot& snapshot, const std::vector<bool>& kept,
                          const std::vector<PondedReach>& ponds, bool only_warn) {
  const auto& line = snapshot.phreatic_line;
  if (line.size() < 2) return;
  double deepest = 0.0, where = 0.0;
  for (const auto& side : element_sides(snapshot)) {
    if (side.neighbour >= 0 || !kept[static_cast<std::size_t>(side.element)]) continue;
    const Point a = place(snapshot, side.to, false), b = place(snapshot, side.from, false);
    if (!(b.x > a.x)) continue;
    for (const Point& p : {a, b}) {
      const double depth = height_of(line, p.x) - p.y;
      const bool weighed = std::any_of(ponds.begin(), ponds.end(), [&](const PondedReach& pond) {
        return (pond.endless[0] || p.x >= pond.extent[0]) && (pond.endless[1] || p.x <= pond.extent[1]) &&
               pond.level - p.y > depth - noticed;
      });
      if (depth <= deepest || weighed) continue;
      deepest = depth;
      where = p.x;
    }
  }
  if (deepest <= noticed) return;
  const std::string found = fmt::format(
      "the phreatic line lies up to {:.3g} m above the ground (at x = {:.4g} m), where no pond of that level is: the "
      "particles would keep the pore pressures of that water without its weight outside",
      deepest, where);
  if (deepest > refused && !only_warn)
    throw InputError(found + "; give it as 'ponded_water' (boundaries of fem.json, or import.json), or lower the line");
  add_warning(found);
}

}  // namespace tailrun::transfer

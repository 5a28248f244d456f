// Ponds that cannot be meant: off the scene, without water, or with a level that belongs to another datum.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "mpm_stage/scene/scene_checks.hpp"
#include "mpm_stage/scene/span.hpp"

namespace tailrun::mpm {

namespace {

// Where there is soil or ground, along x, within the domain. Ground goes on beyond its ends, but nobody drew it there.
Span scene_along_x(const Scene& scene) {
  Span span;
  for (std::size_t p = 0; p < scene.particles.count(); ++p) span.add(scene.particles.position[3 * p]);
  for (const TerrainInput& line : scene.terrain_lines)
    for (const auto& point : line.points) span.add(point[0]);
  if (scene.walls.bounded) span = {std::max(span.low, scene.walls.low[0]), std::min(span.high, scene.walls.high[0])};
  return span;
}

// Of the soil in the pond's range; of all soil where there is none. m.
Span heights_of_soil(const Scene& scene, const Pond& pond) {
  Span inside, all;
  for (std::size_t p = 0; p < scene.particles.count(); ++p) {
    const double* x = &scene.particles.position[3 * p];
    all.add(x[1]);
    if (x[0] >= pond.low[0] && x[0] <= pond.high[0] && x[2] >= pond.low[2] && x[2] <= pond.high[2]) inside.add(x[1]);
  }
  return inside.low <= inside.high ? inside : all;
}

// Whether there is room over the ground and below `level` (m) anywhere in the range.
bool ground_holds_water(const Scene& scene, const Span& along, const Pond& pond, double level) {
  if (scene.terrain.empty()) return false;
  const double low = std::max(along.low, pond.low[0]), high = std::min(along.high, pond.high[0]);
  constexpr int places = 1000;
  for (int i = 0; i <= places; ++i)
    if (scene.terrain.distance(low + (high - low) * i / places, level - 1e-6 * scene.cell_size) > 0.0) return true;
  return false;
}

std::string range_text(const Span& span) {
  return fmt::format("x from {:g} to {:g} m", span.low, span.high);
}

void check_pond(const CaseNode& root, const Scene& scene, const Pond& pond, const Span& along) {
  const std::string name = fmt::format("pond '{}'", pond.name);
  const double level = *std::max_element(pond.level.begin(), pond.level.end());
  if (pond.low[0] > along.high || pond.high[0] < along.low)
    return root.warn("ponded_water",
                     fmt::format("{} lies off the scene and presses on nothing: it has {}, soil and ground have {}",
                                 name, range_text({pond.low[0], pond.high[0]}), range_text(along)));
  const Span soil = heights_of_soil(scene, pond);
  if (level < soil.low && !ground_holds_water(scene, along, pond, level))
    return root.warn("ponded_water",
                     fmt::format("{} has no water: its level, {:g} m, lies below all ground there, and the lowest soil "
                                 "at {:g} m; levels are heights y of the scene",
                                 name, level, soil.low));
  // Soil under water is common, under so much of it on land it is not.
  constexpr double least_depth = 50.0, least_share = 10.0;  // m; 1, of the soil's height
  if (const double depth = level - soil.high; depth > std::max(least_depth, least_share * (soil.high - soil.low)))
    root.warn("ponded_water",
              fmt::format("{} stands {:.4g} m over the highest soil there (level {:g} m, soil up to {:g} "
                          "m): is its level a height y of the scene, in m?",
                          name, depth, level, soil.high));
}

}  // namespace

void check_ponds(const CaseNode& root, const Scene& scene) {
  const Span along = scene_along_x(scene);
  for (const Pond& pond : scene.solver.ponds) check_pond(root, scene, pond, along);
}

}  // namespace tailrun::mpm

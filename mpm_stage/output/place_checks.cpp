#include "mpm_stage/output/place_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm_stage/output/runout_measures.hpp"
#include "mpm_stage/scene/span.hpp"

namespace tailrun::mpm {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

void check_points(const CaseNode& root, const Scene& scene, const std::vector<bool>& moves) {
  const ParticleSet& set = scene.particles;
  for (std::size_t k = 0; k < scene.output.points.size(); ++k) {
    const TrackedPoint& point = scene.output.points[k];
    double least = endless;
    std::size_t nearest = 0;
    for (std::size_t p = 0; p < set.count(); ++p) {
      const double d = std::hypot(set.position[3 * p] - point.position[0], set.position[3 * p + 1] - point.position[1]);
      if (!moves[p] || d >= least) continue;
      least = d;
      nearest = p;
    }
    constexpr double most_cells = 2.0;  // that soil may be off a point of its surface
    if (least > most_cells * scene.cell_size && least < endless)
      root.warn(
          fmt::format("output/points/{}/position", k),
          fmt::format("'{}' at ({:g}, {:g}) m is {:.4g} m from the nearest soil that can move, which is followed in "
                      "its place, at {}",
                      point.name, point.position[0], point.position[1], least,
                      place_text(&set.position[3 * nearest], set.dimension)));
  }
}

// Soil can pass a section that has some behind it, as far as ground was drawn and as much again.
void check_sections(const CaseNode& root, const Scene& scene, const std::vector<bool>& moves) {
  const auto axis = static_cast<std::size_t>(scene.output.front_axis);
  const double sign = scene.output.front_sign;
  Span soil, all;
  for (std::size_t p = 0; p < moves.size(); ++p) {
    const double x = scene.particles.position[3 * p + axis];
    all.add(x);
    if (moves[p]) soil.add(x);
  }
  for (const TerrainInput& line : scene.terrain_lines)
    for (const auto& point : line.points)
      if (axis < 2) all.add(point[axis]);
  Span reach{all.low - all.length(), all.high + all.length()};
  if (scene.walls.bounded)
    reach = {std::max(reach.low, scene.walls.low[axis]), std::min(reach.high, scene.walls.high[axis])};
  for (std::size_t k = 0; k < scene.output.sections.size(); ++k) {
    const FlowSection& section = scene.output.sections[k];
    const double last = sign > 0.0 ? soil.low : soil.high;  // the hindmost soil
    const char* why = sign * (section.at - last) <= 0.0 ? "nothing will pass, all soil that can move lies ahead of it"
                      : section.at < reach.low || section.at > reach.high
                          ? "far beyond the ground that was drawn, which goes on as it ends; is it meant?"
                          : nullptr;
    if (why)
      root.warn(fmt::format("output/sections/{}/at", k),
                fmt::format("'{}' at {:g} m: {} (soil from {:g} to {:g} m, with the ground {:g} to {:g} m)",
                            section.name, section.at, why, soil.low, soil.high, all.low, all.high));
  }
}

void check_toe_and_footprint(const CaseNode& root, const Scene& scene, const std::vector<bool>& moves) {
  const OutputOptions& o = scene.output;
  const std::vector<double> before = positions_before(scene.particles);
  Span soil;
  bool over_footprint = false;
  for (std::size_t p = 0; p < moves.size(); ++p) {
    if (!moves[p]) continue;
    const double x = before[3 * p + static_cast<std::size_t>(o.front_axis)];
    soil.add(x);
    over_footprint = over_footprint || (o.footprint && x >= (*o.footprint)[0] && x <= (*o.footprint)[1]);
  }
  const std::string extent =
      fmt::format("soil that can move lay from {:g} to {:g} m before the motion", soil.low, soil.high);
  // A toe beside the outermost particle, or on ground that slopes away from it, is a fair one.
  const double margin = std::max(2.0 * scene.cell_size, 0.1 * soil.length());
  if (o.toe && (*o.toe < soil.low - margin || *o.toe > soil.high + margin))
    root.warn("output/toe",
              fmt::format("{:g} m is off the dam: {}, and runout is measured from the toe", *o.toe, extent));
  if (o.footprint && !over_footprint)
    root.warn("output/footprint", fmt::format("[{:g}, {:g}] m holds no soil, so no freeboard is measured: {}",
                                              (*o.footprint)[0], (*o.footprint)[1], extent));
}

}  // namespace

void check_output_places(const CaseNode& root, const Scene& scene) {
  const std::vector<bool> moving = moving_materials(scene);
  std::vector<bool> moves(scene.particles.count());
  for (std::size_t p = 0; p < moves.size(); ++p)
    moves[p] = moving[static_cast<std::size_t>(scene.particles.material_id[p])];
  if (std::none_of(moves.begin(), moves.end(), [](bool m) { return m; })) return;
  check_points(root, scene, moves);
  check_sections(root, scene, moves);
  check_toe_and_footprint(root, scene, moves);
}

}  // namespace tailrun::mpm

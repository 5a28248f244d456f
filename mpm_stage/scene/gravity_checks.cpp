// Gravity in another unit, or along another axis than the one that is up here.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "common/plausible_surroundings.hpp"
#include "mpm_stage/scene/scene_checks.hpp"

namespace tailrun::mpm {

namespace {

constexpr double steep = 60.0;  // degrees: scenes that tilt gravity in place of the ground stay below

std::string text_of(const Scene& scene) {
  const auto& g = scene.gravity;
  return scene.dimension == 2 ? fmt::format("[{:g}, {:g}]", g[0], g[1])
                              : fmt::format("[{:g}, {:g}, {:g}]", g[0], g[1], g[2]);
}

// What ground and walls do against gravity. Sides that slip or rub stand against what presses on them; what adheres, is
// fixed or moves holds whatever comes.
struct Support {
  bool any = false, holds = false;
};

Support support_of(const Scene& scene) {
  Support support;
  const auto& g = scene.gravity;
  const double size = std::hypot(g[0], g[1], g[2]), least_share = 1e-6;
  const auto add = [&](double against, bool grips) {
    support.any = true;
    support.holds = support.holds || grips || against < -least_share * size;
  };
  for (const TerrainInput& line : scene.terrain_lines)
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const double tx = line.points[i][0] - line.points[i - 1][0], ty = line.points[i][1] - line.points[i - 1][1];
      add((tx * g[1] - ty * g[0]) / std::hypot(tx, ty), line.adhere);  // material lies on the left
    }
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimension); ++d)
    for (std::size_t s = 0; s < 2; ++s) {
      const WallKind kind = scene.walls.side[d][s].kind;
      if (scene.walls.bounded && kind != WallKind::open) add(s == 0 ? g[d] : -g[d], kind == WallKind::fixed);
    }
  if (!scene.walls.bodies.empty()) add(0.0, true);
  return support;
}

}  // namespace

void check_gravity(const CaseNode& root, const Scene& scene) {
  const auto& g = scene.gravity;
  const double size = std::hypot(g[0], g[1], g[2]);
  if (!(size > 0.0)) return;
  tailrun::check_gravity(root, "gravity", size);
  const double off = std::acos(-g[1] / size) * 180.0 / std::numbers::pi;
  if (const Support support = support_of(scene); support.any && !support.holds)
    root.fail("gravity",
              fmt::format("found {} m/s2, which presses soil on none of the ground lines and walls: it would "
                          "fall off them without end. y is up: gravity is [0, -9.81] unless it is tilted",
                          text_of(scene)));
  if (off > steep)
    root.warn("gravity", fmt::format("{} m/s2 points {:.3g} degrees off straight down; y is up: [0, -9.81] is down",
                                     text_of(scene), off));
}

}  // namespace tailrun::mpm

// "domain" of mpm.json: the corners of the grid, its walls, and what happens to particles that leave.
#include <fmt/core.h>

#include <cmath>

#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

void read_side(const CaseNode& node, const std::string& name, Walls<3>::Side& wall) {
  const std::string kind = node.choice("kind", {"open", "fixed", "slip", "frictional"});
  wall.kind = kind == "open"    ? WallKind::open
              : kind == "fixed" ? WallKind::fixed
              : kind == "slip"  ? WallKind::slip
                                : WallKind::frictional;
  if (wall.kind != WallKind::frictional)
    return refuse_with_other_choice(node, "friction", "kind", kind, "'frictional'");
  wall.friction = node.number("friction", "1", Range::non_negative());
  check_friction(node, "friction", wall.friction, fmt::format("the wall '{}'", name));
}

}  // namespace

void read_domain(const CaseNode& root, Scene& scene) {
  const auto node = root.object_if("domain");
  Walls<3>& walls = scene.walls;
  if (!node) return;
  const auto n = static_cast<std::size_t>(scene.dimension);
  const auto low = node->numbers("low", "m", Range::any(), n), high = node->numbers("high", "m", Range::any(), n);
  walls.bounded = true;
  for (std::size_t d = 0; d < n; ++d) {
    if (!(high[d] > low[d]))
      node->fail("high", fmt::format("is {:g} m along {}, but must be more than low, {:g} m: low is the left lower "
                                     "corner, high the right upper one",
                                     high[d], "xyz"[d], low[d]));
    const double cells = (high[d] - low[d]) / scene.cell_size;
    if (!(std::fabs(cells - std::round(cells)) <= 1e-6))
      node->fail("high", fmt::format("the domain is {} cells of {} m long along {}; it must be a whole number of cells",
                                     cells, scene.cell_size, "xyz"[d]));
    walls.low[d] = scene.origin[d] = low[d];
    walls.high[d] = high[d];
  }
  const CaseNode sides = node->object_or_empty("walls");
  const std::array<std::array<const char*, 2>, 3> names = {{{"left", "right"}, {"bottom", "top"}, {"back", "front"}}};
  for (std::size_t d = 0; d < n; ++d)
    for (std::size_t s = 0; s < 2; ++s)
      if (const auto side = sides.object_if(names[d][s])) read_side(*side, names[d][s], walls.side[d][s]);
  const std::string leaving = node->choice_or("leaving_particles", {"error", "remove", "wall"}, "error");
  walls.leaving = leaving == "error"    ? LeavingParticles::error
                  : leaving == "remove" ? LeavingParticles::remove
                                        : LeavingParticles::wall;
}

}  // namespace tailrun::mpm

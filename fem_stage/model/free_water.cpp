#include "fem_stage/model/free_water.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/warnings.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"
#include "fem_stage/model/soft_fluid.hpp"

namespace tailrun::fem {

namespace {
constexpr double puddle = 0.1;  // m, of water that does not count
}

void warn_of_weightless_water(const Model& model) {
  const FemCase& options = *model.options;
  const Mesh& mesh = model.mesh;
  if (options.phreatic_line.empty() || options.gravity <= 0.0) return;
  std::vector<char> told(mesh.nodes(), 0);  // nodes of which the case says what acts on them
  for (const auto& load : model.loads)
    for (const auto& force : load.forces) told[static_cast<std::size_t>(force.node)] = 1;
  const auto tell = [&](const std::string& line) {
    for (const auto node : mesh.nodes_of_line(line)) told[static_cast<std::size_t>(node)] = 1;
  };
  for (const auto& held : options.boundaries.held_pressure) tell(held.line);
  for (const auto& pond : options.boundaries.ponds)
    for (const auto& line : pond.lines) tell(line);
  const std::vector<char> ground = on_ground_surface(mesh);
  std::size_t all = 0, under = 0, worst = 0;
  double deepest = 0.0;
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    if (!ground[n]) continue;
    ++all;
    const double depth = phreatic_elevation(options.phreatic_line, mesh.x(n)) - mesh.y(n);
    if (told[n] || depth <= puddle) continue;
    ++under;
    if (depth > deepest) {
      deepest = depth;
      worst = n;
    }
  }
  if (under == 0) return;
  add_warning(fmt::format(
      "/phreatic_line: lies above the ground at {} of its {} nodes, by up to {:.3g} m at ({:.4g}, {:.4g}): the pore "
      "pressures have "
      "that water, but its weight does not press on the ground; give it as /boundaries/ponded_water, or lower the line",
      under, all, deepest, mesh.x(worst), mesh.y(worst)));
}

}  // namespace tailrun::fem

#include "fem_stage/model/free_water.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"
#include "fem_stage/model/soft_fluid.hpp"

namespace tailrun::fem {

namespace {
constexpr double puddle = 0.1;        // m, of water that does not count
constexpr double largest_step = 1.0;  // m, between a pond's level and the phreatic line

// "fem.json: " for warnings; errors get it from whoever knows the path.
std::string case_of(const FemCase& options) {
  const auto& texts = options.provenance.texts;
  return texts.empty() ? "" : texts.front().first + ": ";
}

}  // namespace

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
  add_warning(case_of(options) + fmt::format("/phreatic_line: lies above the ground at {} of its {} nodes, by up to "
                                             "{:.3g} m at ({:.4g}, {:.4g}): the pore "
                                             "pressures have "
                                             "that water, but its weight does not press on the ground; give it as "
                                             "/boundaries/ponded_water, or lower the line",
                                             under, all, deepest, mesh.x(worst), mesh.y(worst)));
}

void check_ponds_meet_line(const Model& model) {
  const FemCase& options = *model.options;
  if (options.gravity <= 0.0) return;
  for (const auto& pond : options.boundaries.ponds) {
    std::size_t wet = 0, off = 0, worst = 0;
    double largest = puddle;
    for (const auto& line : pond.lines)
      for (const auto node : nodes_at(model.mesh, {line, {}, pond.where})) {
        const auto n = static_cast<std::size_t>(node);
        if (pond.level - model.mesh.y(n) <= puddle) continue;
        ++wet;
        const double step = std::abs(phreatic_elevation(options.phreatic_line, model.mesh.x(n)) - pond.level);
        off += step > puddle;
        if (step <= largest) continue;
        largest = step;
        worst = n;
      }
    if (off == 0) continue;
    const double x = model.mesh.x(worst), elevation = phreatic_elevation(options.phreatic_line, x);
    const std::string found = fmt::format(
        "{}/level: the pond stands at {:g} m, but the phreatic line lies at {:.4g} m at x = {:.4g} m, {:.3g} m {} it "
        "(off at {} of the {} nodes under its water); where water stands on the ground, line and level are one",
        pond.where, pond.level, elevation, x, largest, elevation < pond.level ? "below" : "above", off, wet);
    if (largest > largest_step)
      throw InputError(
          fmt::format("{}: at most {:g} m apart is allowed. Lay /phreatic_line at {:g} m over the pond's "
                      "lines, up to its shore",
                      found, largest_step, pond.level));
    add_warning(case_of(options) + found);
  }
}

}  // namespace tailrun::fem

#include "fem_stage/model/soft_fluid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/element_mean.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"

namespace tailrun::fem {

double soft_fluid_modulus(double saturation, double fluid_modulus) {
  return 1.0 / (saturation / fluid_modulus + (1.0 - saturation) / atmospheric_pressure);
}

void fill_with_soft_fluid(Model& model) {
  const FemCase& options = *model.options;
  const double modulus = soft_fluid_modulus(options.above_phreatic_line.saturation, options.fluid_bulk_modulus);
  for (std::size_t e = 0; e < model.count(); ++e) {
    const auto centre = model.mesh.centre(e);
    if (centre[1] <= phreatic_elevation(options.phreatic_line, centre[0])) continue;
    model.soft_fluid[e] = 1;
    model.storage[e] = model.porosity[e] / modulus;
    model.stabilisation[e] = 0.0;
  }
}

std::vector<char> on_ground_surface(const Mesh& mesh) {
  std::map<std::array<std::int64_t, 2>, int> owners;
  const auto edge = [&](std::size_t e, std::size_t a) {
    const auto p = mesh.quads[4 * e + a], q = mesh.quads[4 * e + (a + 1) % 4];
    return std::array<std::int64_t, 2>{std::min(p, q), std::max(p, q)};
  };
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (std::size_t a = 0; a < 4; ++a) ++owners[edge(e, a)];
  std::vector<char> surface(mesh.nodes(), 0);
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (std::size_t a = 0; a < 4; ++a) {
      if (owners[edge(e, a)] != 1) continue;
      const auto p = static_cast<std::size_t>(mesh.quads[4 * e + a]),
                 q = static_cast<std::size_t>(mesh.quads[4 * e + (a + 1) % 4]);
      // counter-clockwise elements lie left of their edges, so that one above the soil runs towards -x
      const double back = mesh.x(p) - mesh.x(q);
      if (back > 1e-6 * std::max(back, std::abs(mesh.y(p) - mesh.y(q)))) surface[p] = surface[q] = 1;
    }
  return surface;
}

void soft_fluid_mobility(const Model& model, std::span<const double> pressure, std::span<double> mobility) {
  if (!model.options->above_phreatic_line.soft_fluid) return;
  for (std::size_t e = 0; e < model.count(); ++e) {
    if (!model.soft_fluid[e]) continue;
    mobility[e] = element_mean(model.mesh.quads, pressure, e) > 0.0 ? 1.0 : suction_mobility;
  }
}

}  // namespace tailrun::fem

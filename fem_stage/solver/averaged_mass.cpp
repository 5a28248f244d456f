#include "fem_stage/solver/averaged_mass.hpp"

namespace tailrun::fem {

double averaged_mass_difference(const Model& model, std::size_t e, int a, int b) {
  const double consistent = model.elements.mass_matrix[10 * e + static_cast<std::size_t>(lower(a, b))];
  const double lumped = a == b ? model.elements.nodal_volume[4 * e + static_cast<std::size_t>(a)] : 0.0;
  return 0.5 * model.density[e] * (consistent - lumped);
}

void subtract_averaged_inertia(const Model& model, std::span<const double> acceleration, std::span<double> force) {
  const auto* quads = model.mesh.quads.data();
#pragma omp parallel for schedule(static)
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    double x = 0.0, y = 0.0;
    for (int k = model.adjacency_start[n]; k < model.adjacency_start[n + 1]; ++k) {
      const int corner = model.adjacency[static_cast<std::size_t>(k)];
      const auto e = static_cast<std::size_t>(corner / 4);
      for (int b = 0; b < 4; ++b) {
        const double mass = averaged_mass_difference(model, e, corner % 4, b);
        const auto node = static_cast<std::size_t>(quads[4 * e + static_cast<std::size_t>(b)]);
        x += mass * acceleration[2 * node];
        y += mass * acceleration[2 * node + 1];
      }
    }
    force[2 * n] -= x;
    force[2 * n + 1] -= y;
  }
}

double averaged_kinetic_difference(const Model& model, std::span<const double> velocity) {
  double energy = 0.0;
  for (std::size_t e = 0; e < model.count(); ++e)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const auto na = static_cast<std::size_t>(model.mesh.quads[4 * e + static_cast<std::size_t>(a)]),
                   nb = static_cast<std::size_t>(model.mesh.quads[4 * e + static_cast<std::size_t>(b)]);
        energy += 0.5 * averaged_mass_difference(model, e, a, b) *
                  (velocity[2 * na] * velocity[2 * nb] + velocity[2 * na + 1] * velocity[2 * nb + 1]);
      }
  return energy;
}

}  // namespace tailrun::fem

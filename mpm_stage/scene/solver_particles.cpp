#include <algorithm>

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// What holds no shear stress at rest starts with the mean of the stress given, at the volume given. Below no pressure
// there is none: the particle is as large as it is.
template <int Dim>
void start_at_mean_stress(const Material& m, Particles<Dim>& P, std::size_t p) {
  const double pressure = std::max(0.0, -(P.stress[0][p] + P.stress[1][p] + P.stress[2][p]) / 3.0);
  for (int c = 0; c < stress_components<Dim>; ++c) P.stress[c][p] = c < 3 ? -pressure : 0.0;
  P.rest_volume[p] = P.volume[p] * (1.0 + pressure / m.bulk_modulus);
}

}  // namespace

template <int Dim>
Particles<Dim> solver_particles(const Scene& scene) {
  const ParticleSet& set = scene.particles;
  bool pore = false, rest = false;
  for (const auto& m : scene.materials) {
    pore = pore || m.pore_pressure != PorePressure::total;
    rest = rest || m.law->keeps_rest_volume;
  }
  Particles<Dim> P;
  const TransferName transfer = scene.solver.transfer;
  P.resize(set.count(), transfer == TransferName::apic || transfer == TransferName::aflip, pore, rest);
  if (scene.solver.fields.by_side) P.side.assign(set.count(), 0);
  constexpr int components = stress_components<Dim>;
  for (std::size_t p = 0; p < set.count(); ++p) {
    for (int d = 0; d < Dim; ++d) {
      P.position[d][p] = set.position[3 * p + d];
      P.velocity[d][p] = set.velocity[3 * p + d];
    }
    // Without it the first step's grid would lack the affine share of the momentum: an elastic square 8 cells wide
    // would turn 4.5 % slower than it was told to with APIC.
    if (!P.affine[0].empty() && !scene.velocity_gradient.empty())
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j)
          P.affine[static_cast<std::size_t>(i * Dim + j)][p] =
              scene.velocity_gradient[9 * p + static_cast<std::size_t>(3 * i + j)];
    P.mass[p] = set.mass[p];
    P.volume[p] = set.volume[p];
    P.material[p] = set.material_id[p];
    P.identity[p] = static_cast<std::int32_t>(p);
    P.strength[p] = scene.cohesion[p];
    if (!set.plastic_deviatoric_strain.empty()) P.plastic_strain[p] = set.plastic_deviatoric_strain[p];
    const bool total =
        scene.materials[static_cast<std::size_t>(set.material_id[p])].pore_pressure == PorePressure::total;
    const double u = set.pore_pressure.empty() ? 0.0 : set.pore_pressure[p];
    for (int c = 0; c < components; ++c)
      P.stress[c][p] = set.effective_stress[components * p + c] - (total && c < 3 ? u : 0.0);
    if (pore) P.pore_pressure[p] = total ? 0.0 : u;
    const Material& m = scene.materials[static_cast<std::size_t>(set.material_id[p])];
    if (m.law->keeps_rest_volume) start_at_mean_stress(m, P, p);
  }
  return P;
}

template Particles<2> solver_particles<2>(const Scene&);
template Particles<3> solver_particles<3>(const Scene&);

}  // namespace tailrun::mpm

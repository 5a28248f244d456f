#include "mpm_stage/material/stress_update.hpp"

#include "mpm_stage/material/frozen_pore_pressure.hpp"

namespace tailrun::mpm {

namespace {

template <int Dim>
StressWork update(const LawLoops<Dim>& law, const MaterialConstants& k, Particles<Dim>& P, std::size_t begin,
                  std::size_t end, const double* trace, double dt) {
  if (k.pore_pressure == PorePressure::undrained)
    for (std::size_t p = begin; p < end; ++p) P.pore_pressure[p] -= k.pore_stiffness * trace[p - begin];
  FrozenPorePressure<Dim> water(k, P, begin, end, trace);
  const double dissipated = law.update(k, P, begin, end, trace, dt);
  return {dissipated, water.release()};
}

}  // namespace

StressWork update_stress(const MaterialConstants& k, Particles<2>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt) {
  return update(k.plane, k, P, begin, end, trace, dt);
}

StressWork update_stress(const MaterialConstants& k, Particles<3>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt) {
  return update(k.solid, k, P, begin, end, trace, dt);
}

double elastic_energy(const MaterialConstants& k, const Particles<2>& P, std::size_t begin, std::size_t end) {
  return k.plane.energy(k, P, begin, end);
}

double elastic_energy(const MaterialConstants& k, const Particles<3>& P, std::size_t begin, std::size_t end) {
  return k.solid.energy(k, P, begin, end);
}

}  // namespace tailrun::mpm

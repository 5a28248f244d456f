// The stress of a run of particles of one material after a step: rotate, add the elastic increment, return to the yield
// surface; volume and pore pressure follow.
#pragma once

#include <cmath>
#include <cstddef>

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/scene/particles.hpp"

namespace tailrun::mpm {

// J (per metre in plane strain).
struct StressWork {
  double dissipated = 0.0;     // in plastic and viscous flow
  double pore_pressure = 0.0;  // done by frozen pore pressure on the soil's expansion
};

// Particles begin .. end of `P`, whose `gradient` holds the step's midpoint gradient. `trace` has one volumetric strain
// increment per particle of the run, which takes the place of the particle's own (volumetric_projection.hpp). `dt` s.
// Returns the energy dissipated in plastic and viscous flow, J.
StressWork update_stress(const MaterialConstants& material, Particles<2>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt);
StressWork update_stress(const MaterialConstants& material, Particles<3>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt);

// Work of the fluid's pressure K (1 / J - 1) on its compression to J of its volume, J: K V_0 (J - 1 - ln J).
inline double stored_in_fluid(const MaterialConstants& k, double mass, double volume) {
  const double whole = mass / k.reference_density, J = volume / whole;
  return J < 1.0 || k.allow_tension ? k.bulk * whole * (J - 1.0 - std::log(J)) : 0.0;
}

// Recoverable energy of the stresses, J: s : C^-1 : s / 2 (elastic and elasto-plastic solids), that of the fluid, and
// u^2 / (2 K_f / n) of undrained pore water.
double elastic_energy(const MaterialConstants& material, const Particles<2>& P, std::size_t begin, std::size_t end);
double elastic_energy(const MaterialConstants& material, const Particles<3>& P, std::size_t begin, std::size_t end);

}  // namespace tailrun::mpm

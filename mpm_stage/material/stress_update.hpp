// The stress of a run of particles of one material after a step, by the material's law; volume and pore pressure
// follow.
#pragma once

#include <cstddef>

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

// J (per metre in plane strain).
struct StressWork {
  double dissipated = 0.0;     // in plastic and viscous flow
  double pore_pressure = 0.0;  // done by frozen pore pressure on the soil's expansion
  double crowding = 0.0;       // given as elastic energy to crowded soil (transfer/patch_filling.hpp)
};

// Particles begin .. end of `P`, whose `gradient` holds the step's midpoint gradient. `trace` has one volumetric strain
// increment per particle of the run, which takes the place of the particle's own (volumetric_projection.hpp). `dt` s.
// Returns the energy dissipated in plastic and viscous flow, J.
StressWork update_stress(const MaterialConstants& material, Particles<2>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt);
StressWork update_stress(const MaterialConstants& material, Particles<3>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt);

// Recoverable energy of the stresses, J, and of undrained pore water.
double elastic_energy(const MaterialConstants& material, const Particles<2>& P, std::size_t begin, std::size_t end);
double elastic_energy(const MaterialConstants& material, const Particles<3>& P, std::size_t begin, std::size_t end);

}  // namespace tailrun::mpm

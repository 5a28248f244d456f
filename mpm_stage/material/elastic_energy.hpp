// Recoverable energy of isotropic linear elasticity, for every law that has it under it.
#pragma once

#include <cstddef>

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

// J: s : C^-1 : s / 2, of the mean stress alone where the shear modulus is 0 (fluids: K (ln J)^2 / 2, and viscous
// stress stores nothing); and u^2 / (2 K_f / n) of undrained pore water.
double isotropic_energy(const MaterialConstants& k, const Particles<2>& P, std::size_t begin, std::size_t end);
double isotropic_energy(const MaterialConstants& k, const Particles<3>& P, std::size_t begin, std::size_t end);

}  // namespace tailrun::mpm

// Averaged mass: half lumped, half consistent. Lumping makes waves too slow by (k h)^2/24 and the consistent matrix
// makes them too fast by as much, so that their mean leaves an error of fourth order (Belytschko & Mullen 1978; Hughes,
// The Finite Element Method, section 9.1). Given as its difference from the lumped matrix,
//
//   dM_ab = 1/2 rho (integral N_a N_b dV - delta_ab integral N_a dV)        in each element, rows sum to zero.
#pragma once

#include <span>

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// kg: entry (a, b) of element e's dM.
double averaged_mass_difference(const Model& model, std::size_t e, int a, int b);

// Subtracts dM a from `force` (N, (N, 2)); `acceleration` m/s2, (N, 2). In a fixed order for any number of threads.
void subtract_averaged_inertia(const Model& model, std::span<const double> acceleration, std::span<double> force);

// J: 1/2 v dM v.
double averaged_kinetic_difference(const Model& model, std::span<const double> velocity);

}  // namespace tailrun::fem

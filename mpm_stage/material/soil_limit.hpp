// The largest shear stress that soil passes on to the ground, and to soil of another velocity field.
//
// Ground rougher than soil is strong does not hold the soil beside it: that shears off in a band along the ground, as
// thin as it likes. On the grid the band is one or two cells thick, and what it holds back is missing from the flow: a
// block of clay went 29, 32 and 36 m over rough ground with cells of 1, 0.5 and 0.25 m, but as far with each of them
// over smooth ground. So the ground takes no more than phi = 0 soil can carry, and the body slides on it as a whole.
//
// Not where such a band is no solution: strength that grows with the rate forbids it, softening soil would lose
// strength in it that its particles do not know of, and frictional soil flows as a layer over one at rest.
#pragma once

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/material/strength.hpp"

namespace tailrun::mpm {

// More than any friction, and finite, so that nodes can average: one that soil without a limit reaches, too, has none.
constexpr double no_soil_limit = 1e30;       // Pa
constexpr double smallest_unlimited = 1e15;  // Pa, means over soils of which one has no limit are more

// Pa; `cohesion` is the particle's.
inline double soil_limit(const MaterialConstants& k, double cohesion) {
  return k.phi_zero && !k.softens && k.consistency == 0.0 ? cohesion : no_soil_limit;
}

// Pa, of soil beside soil of another field: phi = 0 soil that softens carries what is left of its cohesion, a fluid
// without viscosity nothing.
inline double interface_strength(const MaterialConstants& k, double cohesion, double plastic_strain) {
  if (!k.flows || k.consistency != 0.0 || k.explicit_viscosity != 0.0) return no_soil_limit;
  if (!k.phi_zero) return 0.0;
  return k.softens ? softened_cohesion(k, cohesion, softening_share(k, plastic_strain)) : cohesion;
}

}  // namespace tailrun::mpm

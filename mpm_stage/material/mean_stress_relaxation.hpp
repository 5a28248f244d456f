// How much of its relaxation (transfer/volumetric_average.hpp) the mean stress of phi = 0 soil takes.
//
// The relaxation is there for soil that flows, and pulls the gradient of the mean stress towards the hydrostatic one.
// In soil much stronger than its load the gradient is another (horizontal stress is a share K0 < 1 of the vertical
// one); pulled at without end, a block of 100 kPa at rest gained energy. So what counts is how much of its strength c
// the soil uses: min(1, J2 / (c/2)^2), all of it from half its strength on.
#pragma once

#include <cmath>
#include <cstddef>

#include "mpm_stage/material/strength.hpp"
#include "mpm_stage/scene/particles.hpp"

namespace tailrun::mpm {

// Second invariant of the deviatoric stress of particle p, Pa2.
template <int Dim>
inline double second_invariant(const Particles<Dim>& P, std::size_t p) {
  const double xx = P.stress[0][p], yy = P.stress[1][p], zz = P.stress[2][p];
  double shear = 0.0;
  for (int k = 3; k < stress_components<Dim>; ++k) shear += P.stress[k][p] * P.stress[k][p];
  return ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) * (1.0 / 6.0) + shear;
}

// Scales shift[0 .. end - begin) (Pa) of the particles begin .. end of a Tresca material before their stress update.
template <int Dim>
void relax_by_used_strength(const MaterialConstants& k, const Particles<Dim>& P, std::size_t begin, std::size_t end,
                            double* shift) {
#pragma omp simd
  for (std::size_t p = begin; p < end; ++p) {
    const double c =
        k.softens ? softened_cohesion(k, P.strength[p], softening_share(k, P.plastic_strain[p])) : P.strength[p];
    const double used = 4.0 * second_invariant(P, p), full = c * c;
    shift[p - begin] *= used < full ? used / full : 1.0;
  }
}

}  // namespace tailrun::mpm

// How much of its relaxation (transfer/volumetric_average.hpp) the mean stress of phi = 0 soil takes.
//
// The relaxation is there for soil that flows, and pulls the gradient of the mean stress towards the hydrostatic one.
// In soil much stronger than its load the gradient is another (horizontal stress is a share K0 < 1 of the vertical
// one); pulled at without end, a block of 100 kPa at rest gained energy. So what counts is how much of its strength c
// the soil uses: min(1, J2 / (c/2)^2), all of it from half its strength on.
#pragma once

#include <cstddef>

#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/strength.hpp"
#include "mpm_stage/scene/particles.hpp"

namespace tailrun::mpm {

// Scales shift[0 .. end - begin) (Pa) of the particles begin .. end of a phi = 0 material before their stress update.
template <int Dim>
void relax_by_used_strength(const MaterialConstants& k, const Particles<Dim>& P, std::size_t begin, std::size_t end,
                            double* shift) {
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        Vec4 c = g.read(P.strength.data());
        if (k.softens) c = softened_cohesion(k, c, softening_share(k, g.read(P.plastic_strain.data())));
        const Vec4 xx = g.read(P.stress[0].data()), yy = g.read(P.stress[1].data()), zz = g.read(P.stress[2].data());
        Vec4 J2 = ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) * (1.0 / 6.0);
        for (int i = 3; i < stress_components<Dim>; ++i) {
          const Vec4 s = g.read(P.stress[i].data());
          J2 += s * s;
        }
        const Vec4 used = 4.0 * J2, full = c * c;
        auto of_run = g;
        of_run.first -= begin;
        of_run.write(shift, of_run.read(shift) * (used < full ? used / full : splat(1.0)));
      });
}

}  // namespace tailrun::mpm

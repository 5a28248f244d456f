// Stress update in plane strain, four particles at a time: the columns of a run of particles, and the elastic trial.
// There are no branches that depend on a particle.
#pragma once

#include <cstddef>

#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

// Columns of the particles from `begin` on; `trace` (1) as update_stress takes it.
struct PlaneColumns {
  double* __restrict gxx, * __restrict gxy, * __restrict gyx, * __restrict gyy;
  double* __restrict sxx, * __restrict syy, * __restrict szz, * __restrict sxy;
  double* __restrict volume, * __restrict strain, * __restrict strength, * __restrict mass;
  const double* __restrict trace;

  PlaneColumns(Particles<2>& P, const double* trace_of_run, std::size_t begin)
      : gxx(P.gradient[0].data() + begin),
        gxy(P.gradient[1].data() + begin),
        gyx(P.gradient[2].data() + begin),
        gyy(P.gradient[3].data() + begin),
        sxx(P.stress[0].data() + begin),
        syy(P.stress[1].data() + begin),
        szz(P.stress[2].data() + begin),
        sxy(P.stress[3].data() + begin),
        volume(P.volume.data() + begin),
        strain(P.plastic_strain.data() + begin),
        strength(P.strength.data() + begin),
        mass(P.mass.data() + begin),
        trace(trace_of_run) {}
};

// Mean and deviator of the in-plane trial stress: sxx = p + q, syy = p - q, sxy = r. `volume_ratio` is det F of the
// averaged increment, 2-D: ((1 + t/4) / (1 - t/4))^2 with t its midpoint trace.
struct PlaneTrial {
  Vec4 p, q, r, zz, shear_rate_squared, volume_ratio;
};

template <class G>
[[gnu::always_inline]] inline PlaneTrial elastic_trial(const MaterialConstants& k, const PlaneColumns& c, const G& g) {
  const Vec4 gxx = g.read(c.gxx), gxy = g.read(c.gxy), gyx = g.read(c.gyx), gyy = g.read(c.gyy);
  const Vec4 sxx = g.read(c.sxx), syy = g.read(c.syy), sxy = g.read(c.sxy);
  const Vec4 trace = g.read(c.trace);
  // Hughes & Winget: Q = (I - W/2)^-1 (I + W/2) turns by theta with tan(theta / 2) = w / 2; the deviator turns by 2
  // theta. One division serves the rotation and the change of volume.
  const Vec4 t = 0.25 * (gyx - gxy), tt = t * t, shrunk = 1.0 - 0.25 * trace;
  const Vec4 both = 1.0 / ((1.0 + tt) * shrunk), r1 = both * shrunk;
  const Vec4 cosine = (1.0 - tt) * r1, sine = 2.0 * t * r1;
  const Vec4 c2 = cosine * cosine - sine * sine, s2 = 2.0 * cosine * sine;
  const Vec4 q0 = 0.5 * (sxx - syy), p0 = 0.5 * (sxx + syy);
  const Vec4 de = 0.5 * (gxx - gyy), dg = 0.5 * (gxy + gyx);
  const Vec4 growth = (1.0 + 0.25 * trace) * (both * (1.0 + tt));
  PlaneTrial o;
  o.p = p0 + (k.lambda + k.mu) * trace;
  o.q = q0 * c2 - sxy * s2 + 2.0 * k.mu * de;
  o.r = q0 * s2 + sxy * c2 + 2.0 * k.mu * dg;
  o.zz = g.read(c.szz) + k.lambda * trace;
  o.shear_rate_squared = 4.0 * (de * de + dg * dg);
  o.volume_ratio = growth * growth;
  return o;
}

}  // namespace tailrun::mpm

// Bringing a sub-step's end back onto the yield cone as OpenSees does it (compatible mode only). Stress and back-stress
// ratio both move along the plastic direction, the stress with the last loading index as a factor:
//
//   sigma <- sigma - lambda L (2 G n + (2/3) (K + G/3) D I),   alpha <- alpha + lambda (2/3) h b,
//   lambda = f / [df/dsigma : (C^e L R) + p (2/3) h B]
//
// The stress's share is about 1e-6 of the whole except near the bounding surface: there B, and with it what alpha can
// do, vanishes, and the strength of soil that flows depends on the stress giving way.
#pragma once

#include "fem_stage/material/pm4_rates.hpp"
#include "fem_stage/material/pm4_yield_cone.hpp"

namespace tailrun::fem {

// What a sub-step leaves for its correction.
struct Pm4DriftState {
  double density_index = 0.0;  // relative density or void ratio
  double L = 0.0;              // loading index
  Pm4Moduli moduli;
};

// Corrects `v` to f <= tolerance; where that does not converge, `v` stays outside the cone for the next sub-step to
// bring back. `M_b`: the bounding ratio last evaluated.
template <class Law>
void correct_drift(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory, double z_peak,
                   const Pm4DriftState& drift, Pm4Variables& v, double& M_b) {
  double f = yield_function(law.m, v.p, v.s, v.alpha);
  if (f < law.tolerance) return;
  const Pm4Variables start = v;
  const double G = drift.moduli.G;
  const double K = drift.moduli.K;
  double p = v.p;
  for (int iteration = 0; iteration < 25; ++iteration) {
    const double p_star = std::max(v.p, point.p_min);
    const Pm4Surfaces surfaces = law.surfaces(point, p_star, drift.density_index);
    M_b = surfaces.M_b;
    const Deviator n = cone_normal(v.p, v.s, v.alpha);
    const double n_r = contract(n, v.s) / p;
    const Pm4Coefficients c =
        coefficients(law, Pm4PlaceOf<double>{point, memory, z_peak, v, surfaces, drift.moduli, n});
    const double size_B = std::fabs(c.B);
    const double hardening = size_B < 1e-10 ? 1e10 : c.H / (p_star * std::sqrt(size_B));  // (2/3) h
    const Deviator b = sqrt_half * (surfaces.M_b - law.m) * n - v.alpha;
    const Deviator ds = (2.0 * G * drift.L) * n;
    const double dp = 2.0 / 3.0 * (K + G / 3.0) * drift.L * c.dilatancy.at(p_star);
    const double lambda = f / (2.0 * G * drift.L - n_r * dp + p * hardening * c.B);
    Pm4Variables moved = v;
    moved.p -= lambda * dp;
    moved.s = v.s - lambda * ds;
    moved.alpha = v.alpha + (lambda * hardening) * b;
    if (std::fabs(yield_function(law.m, moved.p, moved.s, moved.alpha)) < std::fabs(f)) {
      v = moved;
    } else {  // along the yield normal n - (n:r) I/2
      const double length = f / (1.0 + 0.5 * n_r * n_r);
      v.s = v.s - length * n;
      v.p += 0.5 * n_r * length;
    }
    f = yield_function(law.m, v.p, v.s, v.alpha);
    if (std::fabs(f) < law.tolerance && v.p > 0.0) return;
    p = std::max(v.p, point.p_min);
  }
  v = start;
}

}  // namespace tailrun::fem

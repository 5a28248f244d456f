// Constants and functions that PM4Sand and PM4Silt share: everything that follows from the parameters alone, worked out
// once per material so that the rate equations do no avoidable arithmetic.
#pragma once

#include <algorithm>
#include <cmath>

#include "fem_stage/material/pm4_state.hpp"

namespace tailrun::fem {

constexpr double sqrt_half = 0.70710678118654752440;
constexpr double sqrt_two = 1.41421356237309504880;

// How the model is realised. `opensees`: OpenSees' choices one by one (pieces of at most 1e-5 strain, memory and fabric
// records frozen over a global step, its reset at the stress floor). `improved`: rate equations integrated by error
// alone, memory and records followed within the step, direction-preserving reset.
enum class Pm4Compatibility { improved, opensees };

// Where stress outside the bounding surface is brought back to it. `simple_shear`: only where both normal stresses are
// equal (to 5e-8 p_A), as OpenSees' PM4Silt does.
enum class Pm4BoundingClip { always, simple_shear };

// Resolved constants of one material. SI units.
struct Pm4Law {
  double density = 0.0;
  double atmospheric_pressure = 101.3e3;
  double G0_pA = 0.0;  // shear modulus of the elastic stage
  double poisson = 0.3;
  double bulk_over_shear = 0.0;  // K/G = 2/3 (1+nu)/(1-2nu)
  double M = 0.0;                // critical-state q/p = 2 sin phi_cv
  double m = 0.01;
  double h0 = 0.0;
  double h_po = 0.0;
  double C_gamma1 = 0.0;
  double C_Kaf = 0.0;
  double c_z = 0.0;
  double C_GD = 0.0;
  double C_DR = 0.0;
  double index0 = 0.0;       // D_R (sand) or e (silt) at zero volumetric strain
  double index_slope = 0.0;  // its change per unit volumetric strain
  double tolerance = 0.0;    // of the yield function, Pa
  Pm4Compatibility compatibility = Pm4Compatibility::improved;
  Pm4BoundingClip bounding_clip = Pm4BoundingClip::always;
  bool post_shaking = false;

  void set_post_shaking(bool on) { post_shaking = on; }
};

inline double bulk_over_shear_of(double poisson) {
  const double nu = poisson >= 0.5 ? 0.4999 : poisson;
  return 2.0 / 3.0 * (1.0 + nu) / (1.0 - 2.0 * nu);
}

template <class Real>
inline Real macaulay(Real x) {
  return select(x > 0.0, x, 0.0);
}
template <class Real>
inline Real square(Real x) {
  return x * x;
}
template <class Real>
inline Real cube(Real x) {
  return x * x * x;
}

// Unit normal of the yield cone at (p, s): (s - p alpha)/|s - p alpha|; the shear direction at the very axis.
inline Deviator cone_normal(double p, Deviator s, Deviator alpha) {
  const Deviator radius = s - p * alpha;
  const double length = norm(radius);
  if (!(length > 1e-14 * (1.0 + std::fabs(p)))) return {0.0, sqrt_half};
  return (1.0 / length) * radius;
}

// f = |s - p alpha| - sqrt(1/2) m p
inline double yield_function(double m, double p, Deviator s, Deviator alpha) {
  return norm(s - p * alpha) - sqrt_half * m * p;
}

// Elastic moduli of a state (pm4 manuals: stress, stress ratio and fabric dependence).
template <class Law, class Real>
inline Pm4ModuliOf<Real> moduli_of(const Law& law, const Pm4PointConstantsOf<Real>& point,
                                   const Pm4SurfacesOf<Real>& surfaces, Real p, DeviatorOf<Real> s, Real z_cum) {
  const Real p_star = number::max(p, point.p_min);
  Pm4ModuliOf<Real> moduli;
  const Real of_bounding = sqrt_two * norm(s) / (p_star * surfaces.M_b);
  moduli.M_cur = of_bounding * surfaces.M_b;
  const Real ratio = number::min(Real(1.0), square(square(of_bounding)));
  moduli.G = law.modulus_at(p_star) * (1.0 - 0.5 * ratio) * (point.z_max + z_cum) / (point.z_max + law.C_GD * z_cum);
  if (law.post_shaking) moduli.G *= law.post_shaking_factor(point, surfaces, moduli, p_star, z_cum);
  moduli.K = law.bulk_over_shear * moduli.G;
  return moduli;
}

}  // namespace tailrun::fem

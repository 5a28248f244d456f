// Trace-free symmetric tensors of the plane, which is all that PM4Sand's and PM4Silt's back-stress, fabric and loading
// direction are: a = [[d, xy], [xy, -d]] with d = (a_xx - a_yy)/2. Two numbers instead of three, and the trace cannot
// drift away from zero.
#pragma once

#include <cmath>

#include "fem_stage/material/lanes.hpp"

namespace tailrun::fem {

template <class Real>
struct DeviatorOf {
  Real d = 0.0;   // (a_xx - a_yy)/2
  Real xy = 0.0;  // tensor shear component

  friend DeviatorOf operator+(DeviatorOf a, DeviatorOf b) { return {a.d + b.d, a.xy + b.xy}; }
  friend DeviatorOf operator-(DeviatorOf a, DeviatorOf b) { return {a.d - b.d, a.xy - b.xy}; }
  friend DeviatorOf operator*(Real f, DeviatorOf a) { return {f * a.d, f * a.xy}; }
};
using Deviator = DeviatorOf<double>;

// a:b = a_xx b_xx + a_yy b_yy + 2 a_xy b_xy
template <class Real>
inline Real contract(DeviatorOf<Real> a, DeviatorOf<Real> b) {
  return 2.0 * (a.d * b.d + a.xy * b.xy);
}
template <class Real>
inline Real norm(DeviatorOf<Real> a) {
  return number::sqrt(2.0 * (a.d * a.d + a.xy * a.xy));
}

inline DeviatorOf<Lanes> select(LaneMask m, DeviatorOf<Lanes> a, DeviatorOf<Lanes> b) {
  return {select(m, a.d, b.d), select(m, a.xy, b.xy)};
}

// Components (xx, yy, xy) of a tensor whose trace is not kept at zero (the component-wise records of the back-stress).
template <class Real>
struct PlaneComponentsOf {
  Real xx = 0.0;
  Real yy = 0.0;
  Real xy = 0.0;
};
using PlaneComponents = PlaneComponentsOf<double>;

inline PlaneComponents components(Deviator a) {
  return {a.d, -a.d, a.xy};
}
template <class Real>
inline DeviatorOf<Real> deviator(const PlaneComponentsOf<Real>& a) {
  return {0.5 * (a.xx - a.yy), a.xy};
}

// A strain increment: volumetric strain, (e_xx - e_yy)/2 and tensor shear. Its product with a trace-free n needs no
// more.
template <class Real>
struct PlaneStrainOf {
  Real volumetric = 0.0;
  DeviatorOf<Real> deviator;
};
using PlaneStrain = PlaneStrainOf<double>;

}  // namespace tailrun::fem

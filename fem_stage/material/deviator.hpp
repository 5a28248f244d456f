// Trace-free symmetric tensors of the plane, which is all that PM4Sand's and PM4Silt's back-stress, fabric and loading
// direction are: a = [[d, xy], [xy, -d]] with d = (a_xx - a_yy)/2. Two numbers instead of three, and the trace cannot
// drift away from zero.
#pragma once

#include <cmath>

namespace tailrun::fem {

struct Deviator {
  double d = 0.0;   // (a_xx - a_yy)/2
  double xy = 0.0;  // tensor shear component
};

inline Deviator operator+(Deviator a, Deviator b) {
  return {a.d + b.d, a.xy + b.xy};
}
inline Deviator operator-(Deviator a, Deviator b) {
  return {a.d - b.d, a.xy - b.xy};
}
inline Deviator operator*(double f, Deviator a) {
  return {f * a.d, f * a.xy};
}

// a:b = a_xx b_xx + a_yy b_yy + 2 a_xy b_xy
inline double contract(Deviator a, Deviator b) {
  return 2.0 * (a.d * b.d + a.xy * b.xy);
}
inline double norm(Deviator a) {
  return std::sqrt(2.0 * (a.d * a.d + a.xy * a.xy));
}

// Components (xx, yy, xy) of a tensor whose trace is not kept at zero (the component-wise records of the back-stress).
struct PlaneComponents {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
};

inline PlaneComponents components(Deviator a) {
  return {a.d, -a.d, a.xy};
}
inline Deviator deviator(const PlaneComponents& a) {
  return {0.5 * (a.xx - a.yy), a.xy};
}

// A strain increment: volumetric strain, (e_xx - e_yy)/2 and tensor shear. Its product with a trace-free n needs no
// more.
struct PlaneStrain {
  double volumetric = 0.0;
  Deviator deviator;
};

}  // namespace tailrun::fem

// Four doubles as one value. A grid node is such a value (mass and momentum, or velocity), so that one particle adds to
// one node with one load, two multiply-adds and one store, on any machine that the compiler knows.
#pragma once

namespace tailrun::mpm {

using Vec4 = double __attribute__((vector_size(32)));

inline Vec4 splat(double a) {
  return Vec4{a, a, a, a};
}

}  // namespace tailrun::mpm

// The longest steps that a particle alone on its nodes bears.
//
// A particle that no other shares its nodes with, as it flies, at a corner or in a velocity field of few particles,
// breathes on them. Its strain follows the nodes' velocities after their own forces, so with S = sum (w')^2 / w and the
// modulus M of equal strain in all directions, up to Dim rho c^2, that grows from M dt^2 / (rho h^2) = 2 / (S - 2) on:
// dt = sqrt(2 / (Dim (S - 2))) h / c at the worst place in a cell.
//
// So it is with quadratic splines (0.55 grows, see the tests); linear functions and GIMP bear up to twice that.
#pragma once

#include <cmath>

namespace tailrun::mpm {

// 1, of h / c, in `dimension` directions; S as the shape function says (largest_stiffness in shape_functions.hpp).
inline double longest_courant(double S, int dimension) {
  return std::sqrt(2.0 / (dimension * (S - 2.0)));
}

}  // namespace tailrun::mpm

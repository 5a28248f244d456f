// The longest steps that a particle alone on its nodes bears.
//
// A particle that no other shares its nodes with, as it flies, at a corner or in a velocity field of few particles,
// breathes on them. Its strain follows the nodes' velocities after their own forces, so with S = sum (w')^2 / w and the
// modulus M of equal strain in all directions, up to Dim rho c^2, that grows from
//   M dt^2 / (rho h^2) = 4 / S           where particles carry the velocity's gradient (linear functions, GIMP),
//                        2 / (S - 2)     where they carry the affine velocity of B-splines
// on, at the worst place in a cell. Where sparse soil is softened (transfer/sparse_patches.hpp), steps may be longer.
#pragma once

#include <cmath>

namespace tailrun::mpm {

// 1, of h / c, with a shape function of shape_functions.hpp in `dimension` directions.
template <class Shape>
double longest_courant(int dimension) {
  constexpr double S = Shape::largest_stiffness;
  return std::sqrt((Shape::apic > 0.0 ? 2.0 / (S - 2.0) : 4.0 / S) / dimension);
}

}  // namespace tailrun::mpm

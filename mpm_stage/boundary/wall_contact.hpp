// Unilateral frictional contact of a grid node with a wall of the grid, as an impulse in momentum: what comes towards
// the wall is stopped, what slides along it loses at most friction times that impulse (Coulomb).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace tailrun::mpm {

// `n` is the wall's unit normal towards the material. Returns the energy that sliding takes, per unit mass (J/kg).
template <int Dim>
inline double apply_wall_contact(std::array<double, Dim>& v, const std::array<double, Dim>& n, double friction) {
  double vn = 0.0;
  for (int d = 0; d < Dim; ++d) vn += v[d] * n[d];
  if (vn >= 0.0) return 0.0;
  std::array<double, Dim> t;
  double sliding = 0.0;
  for (int d = 0; d < Dim; ++d) {
    t[d] = v[d] - vn * n[d];
    sliding += t[d] * t[d];
  }
  sliding = std::sqrt(sliding);
  const double left = std::max(0.0, sliding + friction * vn);
  const double share = sliding > 0.0 ? left / sliding : 0.0;
  for (int d = 0; d < Dim; ++d) v[d] = share * t[d];
  return (sliding - left) * left;
}

}  // namespace tailrun::mpm

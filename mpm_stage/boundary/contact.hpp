// Unilateral frictional contact of a grid node with a rigid surface, as an impulse in momentum: what comes towards the
// surface is stopped, what slides along it loses at most friction times that impulse (Coulomb). The sum of the impulses
// over all nodes is what carries the body's weight, so sliding friction is right whatever the cells' alignment.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace tailrun::mpm {

// `v` is the velocity relative to the surface, `n` its unit normal towards the material; `adhere` holds the node. The
// approach is free up to the speed `allowed` (m/s), at which the gap between material and ground closes in this step: a
// node's shape function reaches over a gap, and without this material would come to rest in the air and climb a little
// with each bounce.
// Returns the energy that sliding takes, per unit mass (J/kg): the friction impulse times the velocity that the node
// keeps, for it is that velocity which displaces it. Stopping the approach takes no energy from a body at rest on the
// ground; from one that falls on it it does, and the ledger finds that in its residual.
template <int Dim>
inline double apply_contact(std::array<double, Dim>& v, const std::array<double, Dim>& n, double friction, bool adhere,
                            double allowed) {
  if (adhere && allowed == 0.0) {
    v.fill(0.0);
    return 0.0;
  }
  double vn = 0.0;
  for (int d = 0; d < Dim; ++d) vn += v[d] * n[d];
  if (vn + allowed >= 0.0) return 0.0;
  std::array<double, Dim> t;
  double sliding = 0.0;
  for (int d = 0; d < Dim; ++d) {
    t[d] = v[d] - vn * n[d];
    sliding += t[d] * t[d];
  }
  sliding = std::sqrt(sliding);
  const double left = std::max(0.0, sliding + friction * (vn + allowed));
  const double share = sliding > 0.0 ? left / sliding : 0.0;
  for (int d = 0; d < Dim; ++d) v[d] = share * t[d] - allowed * n[d];
  return (sliding - left) * left;
}

}  // namespace tailrun::mpm

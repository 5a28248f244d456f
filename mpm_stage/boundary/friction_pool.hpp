// How nodes share the friction that they may exert, on the ground (ground_friction.hpp) and between velocity fields
// (field_friction.hpp).
//
// Each node's own is spread over the nodes in contact around it (a cell in every direction) in proportion to the
// momentum to be stopped there: all lose the same share of it, and what a node does not need to stop serves those that
// still slide. Spread by mass, slow sliding stopped the heavy nodes alone and wasted the rest of their share, and phi =
// 0 slopes with a factor of safety of 1.2 crept for ever. The sum is untouched, and no node gets more than stops it.
//
// A `Grip` is a node in contact (any()), with the impulses (N s) that Coulomb's law (friction) and the soil's strength
// (carried) allow, of which the less counts, and the momentum to be stopped (sliding).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

// What a node spreads, over the sliding momenta around it, 1.
struct Spread {
  double friction = 0.0, carried = 0.0;
};

// action(k) for the nodes around node n, itself among them: numbers in arrays by blocks. `around`: the blocks around
// its own, -1 where there is none.
template <int Dim, class Action>
void for_each_beside(const std::array<int, Block<Dim>::neighbours>& around, int n, Action action) {
  for (int s = 0; s < Block<Dim>::neighbours; ++s) {
    const auto k = node_beside<Dim>(around, n, neighbour_step<Dim>(s));
    if (k >= 0) action(static_cast<std::size_t>(k));
  }
}

// Of node n of block `block`.
template <int Dim, class Grip>
Spread spread_of(const std::array<int, Block<Dim>::neighbours>& around, const Grip* grip, std::size_t block, int n) {
  const Grip& own = grip[block * Block<Dim>::nodes + static_cast<std::size_t>(n)];
  if (!own.any()) return {};
  double sliding = 0.0;
  for_each_beside<Dim>(around, n, [&](std::size_t k) { sliding += grip[k].sliding; });
  return sliding > 0.0 ? Spread{own.friction / sliding, own.carried / sliding} : Spread{};
}

// N s, what brakes node n, whose grip is `own`, from the spreads around it. May be more than stops it.
template <int Dim, class Grip>
double pooled_impulse(const std::array<int, Block<Dim>::neighbours>& around, const Grip& own, const Spread* spread,
                      int n) {
  Spread sum;
  for_each_beside<Dim>(around, n, [&](std::size_t k) {
    sum.friction += spread[k].friction;
    sum.carried += spread[k].carried;
  });
  return std::min(sum.friction, sum.carried) * own.sliding;
}

// Coulomb's push averaged over time (m/s2, impulse over mass and time; ground_friction.hpp says why): `smoothed` is the
// node's memory, 0 without one, and goes the `share` of the way to `now`.
inline double remembered(double now, double share, double& smoothed) {
  smoothed = smoothed > 0.0 ? smoothed + share * (now - smoothed) : now;
  return smoothed;
}

}  // namespace tailrun::mpm

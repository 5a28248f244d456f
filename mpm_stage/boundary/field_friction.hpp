// Friction between velocity fields, after their approach has been stopped. What nodes may take off the sliding of two
// bodies is pooled as on the ground (ground_friction.hpp): spread over the nodes around (a cell in every direction) at
// which the same fields touch, in proportion to the momentum to be stopped there. So none is wasted where bodies stick,
// and those that stick do not creep. As there, the push that Coulomb's friction follows is smoothed over time; what
// counts as sliding is the motion of either body through the grid, since the memory is the node's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "mpm_stage/boundary/soil_limit.hpp"
#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/field_choice.hpp"

namespace tailrun::mpm {

template <int Dim>
double along(const std::array<double, Dim>& a, const std::array<double, Dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < Dim; ++d) sum += a[d] * b[d];
  return sum;
}

// Of two bodies at a node; masses 0: they do not touch.
template <int Dim>
struct FieldGrip {
  std::array<double, 2> mass{};          // kg
  std::array<std::uint8_t, 2> fields{};  // of either body, as bits
  std::array<double, Dim> normal{};      // from the first to the second
  double friction = 0.0, carried = 0.0;  // N s: Coulomb's, and what the weaker soil carries
  double sliding = 0.0;                  // N s, the momentum that stopping would take

  bool any() const { return mass[0] > 0.0; }
  double reduced_mass() const { return mass[0] * mass[1] / (mass[0] + mass[1]); }
  // `other`, of the same bodies, presses them together once more.
  void press(const FieldGrip& other) {
    if (any() && other.any() && friction < no_soil_limit)
      friction += other.friction;
    else if (other.any())
      *this = other;
  }
  // Coulomb's friction from the push of the last steps, as on the ground: `smoothed` (m/s2) is the node's memory, 0
  // without one, that goes the `share` of the way to the present push.
  void smooth(double dt, double share, double& smoothed) {
    const double now = friction / (reduced_mass() * dt);
    smoothed = smoothed > 0.0 ? smoothed + share * (now - smoothed) : now;
    friction = smoothed * reduced_mass() * dt;
  }
};

// Number of a pair of fields, i < j, among those of `count` fields.
constexpr int pair_of(int i, int j, int count) {
  return i * (2 * count - i - 1) / 2 + j - i - 1;
}
constexpr int pairs_of(int count) {
  return count * (count - 1) / 2;
}

// m/s, the part of u across the normal.
template <int Dim>
std::array<double, Dim> sliding_of(const FieldGrip<Dim>& grip, std::array<double, Dim> u) {
  const double across = along<Dim>(u, grip.normal);
  for (int d = 0; d < Dim; ++d) u[d] -= across * grip.normal[d];
  return u;
}

// Shares of the sliding momenta around a node that its own friction and strength could stop, 1.
struct FieldSpread {
  double friction = 0.0, carried = 0.0;
};

// Those of node n. `grip` and `spread` are one pair's by the blocks that fields share; `around` says which of these are
// beside this one.
template <int Dim>
FieldSpread spread_of(const std::array<int, Block<Dim>::neighbours>& around, const FieldGrip<Dim>* grip,
                      std::size_t block, int n) {
  const FieldGrip<Dim>& own = grip[block * Block<Dim>::nodes + static_cast<std::size_t>(n)];
  if (!own.any()) return {};
  double sliding = 0.0;
  for (int s = 0; s < Block<Dim>::neighbours; ++s) {
    const auto k = node_beside<Dim>(around, n, neighbour_step<Dim>(s));
    if (k >= 0) sliding += grip[static_cast<std::size_t>(k)].sliding;
  }
  return sliding > 0.0 ? FieldSpread{own.friction / sliding, own.carried / sliding} : FieldSpread{};
}

// N s, what brakes node n.
template <int Dim>
double pooled_impulse(const std::array<int, Block<Dim>::neighbours>& around, const FieldGrip<Dim>& own,
                      const FieldSpread* spread, int n) {
  FieldSpread sum;
  for (int s = 0; s < Block<Dim>::neighbours; ++s) {
    const auto k = node_beside<Dim>(around, n, neighbour_step<Dim>(s));
    if (k < 0) continue;
    sum.friction += spread[static_cast<std::size_t>(k)].friction;
    sum.carried += spread[static_cast<std::size_t>(k)].carried;
  }
  return std::min(sum.friction, sum.carried) * own.sliding;
}

}  // namespace tailrun::mpm

// Friction between velocity fields, after their approach has been stopped: as on the ground, nodes at which the same
// fields touch share what they have (friction_pool.hpp), so that none is wasted where bodies stick, and the push that
// Coulomb's friction follows is averaged over time; what counts as sliding for that is the motion of either body
// through the grid, since the memory is the node's.
#pragma once

#include <array>
#include <cstdint>

#include "mpm_stage/boundary/friction_pool.hpp"
#include "mpm_stage/grid/field_choice.hpp"
#include "mpm_stage/material/soil_limit.hpp"

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
  // Coulomb's friction from the push of the last steps.
  void smooth(double dt, double share, double& smoothed) {
    const double per_push = reduced_mass() * dt;
    friction = per_push * remembered(friction / per_push, share, smoothed);
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

}  // namespace tailrun::mpm

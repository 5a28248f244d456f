// Directions in which contact holds a node in the present step: what is added to its velocity afterwards must have no
// part along them, or contact would be undone.
#pragma once

#include <array>
#include <cmath>

#include "mpm_stage/boundary/contact_nodes.hpp"
#include "mpm_stage/boundary/ground_friction.hpp"
#include "mpm_stage/boundary/wall_nodes.hpp"

namespace tailrun::mpm {

template <int Dim>
class HeldDirections {
 public:
  using Vector = std::array<double, Dim>;

  void hold(Vector n) {
    release(n);
    double length = 0.0;
    for (const double x : n) length += x * x;
    length = std::sqrt(length);
    if (count_ == Dim || length < 1e-6) return;  // held already
    for (double& x : n) x /= length;
    direction_[count_++] = n;
  }
  void hold_all() {
    count_ = Dim;
    for (int d = 0; d < Dim; ++d) {
      direction_[d] = {};
      direction_[d][d] = 1.0;
    }
  }
  bool any() const { return count_ > 0; }
  // Takes the part along the held directions off v.
  void release(Vector& v) const {
    for (int k = 0; k < count_; ++k) {
      double along = 0.0;
      for (int d = 0; d < Dim; ++d) along += v[d] * direction_[k][d];
      for (int d = 0; d < Dim; ++d) v[d] -= along * direction_[k][d];
    }
  }

 private:
  std::array<Vector, Dim> direction_{};  // orthonormal
  int count_ = 0;
};

// Ground: the normal where the approach was stopped (at `allowed`, m/s, ground_friction.hpp), and all directions along
// the ground where friction has stopped the sliding. `v` is the velocity after contact; what is below `slack` (m/s) is
// rounding.
template <int Dim>
void hold_by_ground(const NodeContact& contact, const NodeGrip& grip, double allowed, double slack,
                    const std::array<double, Dim>& v, HeldDirections<Dim>& held) {
  const auto vector = [](double x, double y) {
    std::array<double, Dim> n{};
    n[0] = x;
    n[1] = y;
    return n;
  };
  for (int k = 0; k < contact.count; ++k) {
    const auto& n = contact.point[k].normal;
    if (v[0] * n[0] + v[1] * n[1] + allowed <= slack) held.hold(vector(n[0], n[1]));
  }
  bool still = true;
  for (int d = 0; d < Dim; ++d) still = still && std::fabs(v[d]) <= slack;
  if (contact.adhere && still) {
    held.hold_all();
  } else if (grip.mass > 0.0 && grip.friction > 0.0) {
    const double vn = v[0] * grip.normal[0] + v[1] * grip.normal[1];
    for (int d = 0; d < Dim; ++d)
      if (std::fabs(v[d] - (d < 2 ? vn * grip.normal[d] : 0.0)) > slack) return;
    held.hold(vector(-grip.normal[1], grip.normal[0]));
    if constexpr (Dim == 3) held.hold({0.0, 0.0, 1.0});
  }
}

template <int Dim>
std::array<double, Dim> along_ground(const NodeGrip& grip, std::array<double, Dim> v) {
  const double vn = v[0] * grip.normal[0] + v[1] * grip.normal[1];
  v[0] -= vn * grip.normal[0];
  v[1] -= vn * grip.normal[1];
  return v;
}

// Stops a node that slid with `before` along the ground where its velocity `v` goes back: friction follows from
// `before` and must not turn it round.
template <int Dim>
void stop_return(const NodeGrip& grip, const std::array<double, Dim>& before, std::array<double, Dim>& v) {
  if (grip.mass <= 0.0 || grip.friction <= 0.0) return;
  const auto slid = along_ground<Dim>(grip, before), slides = along_ground<Dim>(grip, v);
  double together = 0.0;
  for (int d = 0; d < Dim; ++d) together += slid[d] * slides[d];
  if (together >= 0.0) return;
  for (int d = 0; d < Dim; ++d) v[d] -= slides[d];
}

// How much faster (m/s) a node goes with `v` than with `before` against the friction that `before` sets; 0 where
// friction had stopped it.
template <int Dim>
double friction_path(const NodeGrip& grip, const std::array<double, Dim>& before, const std::array<double, Dim>& v) {
  const auto slid = along_ground<Dim>(grip, before), slides = along_ground<Dim>(grip, v);
  double square = 0.0, together = 0.0;
  for (int d = 0; d < Dim; ++d) {
    square += slid[d] * slid[d];
    together += slid[d] * slides[d];
  }
  return square > 0.0 ? (together - square) / std::sqrt(square) : 0.0;
}

// Frictional walls of the grid.
template <int Dim>
void hold_by_walls(const WallNodes<Dim>& walls, const std::array<int, Dim>& node, double slack,
                   const std::array<double, Dim>& v, HeldDirections<Dim>& held) {
  for (int d = 0; d < Dim; ++d)
    for (int s = 0; s < 2; ++s) {
      const auto& side = walls.side[d][s];
      if (side.kind != WallKind::frictional || (s == 0 ? node[d] > side.node : node[d] < side.node)) continue;
      if (std::fabs(v[d]) > slack) continue;
      std::array<double, Dim> n{};
      n[d] = 1.0;
      held.hold(n);
      double fastest = 0.0;
      for (const double x : v) fastest = std::max(fastest, std::fabs(x));
      if (side.friction > 0.0 && fastest <= slack) held.hold_all();
    }
}

}  // namespace tailrun::mpm

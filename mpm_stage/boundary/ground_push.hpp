// The ground's push on material at a node: the normal part of its contact. What rubs is in ground_friction.hpp.
//
// The approach is free up to `allowed` (m/s), at which the gap between material and ground closes in this step
// (contact_gap.hpp): a node's shape function reaches over a gap, and without this material would come to rest in the
// air and climb a little with each bounce.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/boundary/contact_nodes.hpp"

namespace tailrun::mpm {

// State of a node after the normal part of contact. mass 0: not in contact.
struct NodeGrip {
  double mass = 0.0;      // kg
  double friction = 0.0;  // N s, friction coefficient times normal impulse
  std::array<double, 2> normal{};
  double carried = 0.0;  // N s, what the soil can carry
  double sliding = 0.0;  // N s, momentum along the ground before friction
  bool pushed = false;   // in this step the ground has stopped an approach

  bool any() const { return mass > 0.0; }
};

// The push on one body, to be taken in turn with whatever else pushes it. Impulses are sums over the turns and may
// shrink again, but not below zero (projected Gauss-Seidel: Jean 1999, "The non-smooth contact dynamics method"): what
// comes out is the velocity nearest to the free one that no contact forbids, whichever contact was asked first.
template <int Dim>
class GroundPush {
 public:
  GroundPush() = default;  // no ground
  // `mass` is the body's (kg).
  GroundPush(const NodeContact& contact, double mass, double allowed)
      : contact_(&contact), mass_(mass), allowed_(allowed), holds_(contact.adhere && allowed == 0.0) {}

  // Stops the approach of the body's velocity v. Returns by how much the impulse changed (N s).
  double press(std::array<double, Dim>& v) {
    double change = 0.0;
    for (int k = 0; k < count(); ++k) {
      const auto& n = contact_->point[k].normal;
      const double approach = -(v[0] * n[0] + v[1] * n[1]) - allowed_;
      const double before = normal_[k];
      normal_[k] = std::max(0.0, before + mass_ * approach);
      const double dv = (normal_[k] - before) / mass_;
      for (int d = 0; d < 2; ++d) {
        v[d] += dv * n[d];
        impulse_[d] += mass_ * dv * n[d];
      }
      change += std::fabs(normal_[k] - before);
    }
    if (holds_) {
      for (int d = 0; d < Dim; ++d) {
        change += mass_ * std::fabs(v[d]);
        impulse_[d] -= mass_ * v[d];
      }
      v.fill(0.0);
    }
    return change;
  }

  NodeGrip grip() const {
    NodeGrip grip;
    grip.pushed = holds_;
    for (int k = 0; k < count(); ++k) {
      if (normal_[k] <= 0.0) continue;
      grip.mass = mass_;
      grip.pushed = true;
      grip.friction += contact_->point[k].friction * normal_[k];
      grip.normal = contact_->point[k].normal;
    }
    return grip;
  }

  // N s, what the body has got.
  const std::array<double, Dim>& impulse() const { return impulse_; }

 private:
  int count() const { return contact_ && !holds_ ? contact_->count : 0; }

  const NodeContact* contact_ = nullptr;
  double mass_ = 0.0, allowed_ = 0.0;
  bool holds_ = false;              // ground that soil adheres to
  std::array<double, 2> normal_{};  // N s, of the points of the ground
  std::array<double, Dim> impulse_{};
};

// Stops the approach of a node that nothing but the ground pushes.
template <int Dim>
NodeGrip stop_approach(const NodeContact& contact, double mass, double allowed, std::array<double, Dim>& v) {
  GroundPush<Dim> push(contact, mass, allowed);
  // Two surfaces of a corner are taken in turn, twice, so that neither is left pushed through.
  for (int r = 0; r < (contact.count > 1 ? 2 : 1); ++r) push.press(v);
  return push.grip();
}

}  // namespace tailrun::mpm

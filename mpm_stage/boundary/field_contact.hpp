// Contact between the velocity fields at one node (Bardenhagen, Brackbill & Sulsky 2000, with other normals and another
// strength).
//
// phi = 0 soil does not slide on stronger soil beside it as long as both share a velocity: it sticks, shears inside
// itself over some three cells, and a slide's length depends on the cell. With a velocity of its own it slides as soon
// as the shear stress reaches what it carries.
//
// Bodies i and j at a node, with velocities after forces and body acceleration and a surface with normal n and area A
// between them (contact_surface.hpp): the approach (v_i - v_j) . n is stopped, their sliding is braked
// (field_friction.hpp) by at most
//   min(dt A min(s_i, s_j), mu J)
// where s is the shear stress that the soil carries and J the normal impulse. Impulses act on both, so momentum is
// exact, and each takes kinetic energy.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mpm_stage/boundary/contact_surface.hpp"
#include "mpm_stage/boundary/field_friction.hpp"
#include "mpm_stage/grid/field_choice.hpp"
#include "mpm_stage/material/soil_limit.hpp"

namespace tailrun::mpm {

enum class Opening { free, held };

struct FieldContactLaw {
  // 1, of the normal impulse; negative: what holds is the strength of the weaker soil alone.
  double friction = -1.0;
  Opening opening = Opening::free;
};

// One field, or several that move as one, at a node.
template <int Dim>
struct BodyAtNode {
  using Vector = std::array<double, Dim>;
  double mass = 0.0;     // kg
  Vector v{}, before{};  // m/s, after forces; at the step's start

  void add(const BodyAtNode& o) {
    const double m = mass + o.mass;
    for (int d = 0; d < Dim; ++d) {
      v[d] = (mass * v[d] + o.mass * o.v[d]) / m;
      before[d] = (mass * before[d] + o.mass * o.before[d]) / m;
    }
    mass = m;
  }
};

// What contact does between two bodies of a node, worked out once and used in each round.
template <int Dim>
class ContactPair {
 public:
  using Vector = std::array<double, Dim>;

  ContactPair() = default;
  ContactPair(BodyAtNode<Dim>& i, BodyAtNode<Dim>& j, const ContactSurface<Dim>& surface, const FieldContactLaw& law,
              double dt)
      : i_(&i),
        j_(&j),
        law_(law),
        n_(surface.normal()),
        reduced_(i.mass * j.mass / (i.mass + j.mass)),
        mixed_(surface.mixed()),
        presses_(surface.presses()) {
    if (mixed_ || !surface.known()) return;
    touches_ = surface.gap() <= 0.0 || law.opening == Opening::held;
    allowed_ = touches_ ? 0.0 : surface.gap() / dt;
    cohesive_ = surface.strength() < no_soil_limit ? dt * surface.area() * surface.strength() : no_soil_limit;
  }

  double approach() const { return along<Dim>(i_->v, n_) - along<Dim>(j_->v, n_); }

  // Adds to the normal impulse what stops the approach; soils mixed through each other come to move as one. Returns by
  // how much the impulse changed (N s).
  double press() {
    if (mixed_) return join();
    if (!presses_) return 0.0;
    double impulse = normal_ + reduced_ * (approach() - allowed_);
    if (law_.opening == Opening::free) impulse = std::max(0.0, impulse);
    const double change = impulse - normal_;
    normal_ = impulse;
    push(n_, change);
    return std::fabs(change);
  }

  // What brakes their sliding; nothing, with mass 0, where they do not touch.
  FieldGrip<Dim> grip() const {
    FieldGrip<Dim> grip;
    if (mixed_ || (!touches_ && normal_ <= 0.0)) return grip;
    grip.mass = {i_->mass, j_->mass};
    grip.normal = n_;
    grip.carried = cohesive_;
    grip.friction = law_.friction >= 0.0 ? law_.friction * std::max(0.0, normal_) : no_soil_limit;
    return grip;
  }

 private:
  double join() {
    double change = 0.0;
    for (int d = 0; d < Dim; ++d) {
      change += reduced_ * std::fabs(i_->v[d] - j_->v[d]);
      const double together = (i_->mass * i_->v[d] + j_->mass * j_->v[d]) / (i_->mass + j_->mass);
      i_->v[d] = j_->v[d] = together;
    }
    return change;
  }
  // Body i loses `amount` times `direction` (N s) to body j.
  void push(const std::array<double, Dim>& direction, double amount) {
    for (int d = 0; d < Dim; ++d) {
      i_->v[d] -= amount * direction[d] / i_->mass;
      j_->v[d] += amount * direction[d] / j_->mass;
    }
  }

  BodyAtNode<Dim>*i_ = nullptr, *j_ = nullptr;
  FieldContactLaw law_;
  Vector n_{};
  double reduced_ = 0.0, allowed_ = 0.0, cohesive_ = 0.0, normal_ = 0.0;
  bool mixed_ = false, presses_ = false, touches_ = false;
};

// The few pairs of a node.
template <int Dim>
class ContactPairs {
 public:
  // Of the node's bodies i and j.
  void add(const ContactPair<Dim>& pair, int i, int j) {
    bodies_[count_] = {i, j};
    pairs_[count_++] = pair;
  }
  int count() const { return count_; }
  // Each in turn, once. Returns by how much their impulses changed (N s).
  double press() {
    double change = 0.0;
    for (ContactPair<Dim>& pair : *this) change += pair.press();
    return change;
  }
  std::pair<int, int> bodies(int k) const { return bodies_[k]; }
  const ContactPair<Dim>& operator[](int k) const { return pairs_[k]; }
  ContactPair<Dim>* begin() { return pairs_.data(); }
  ContactPair<Dim>* end() { return pairs_.data() + count_; }

 private:
  std::array<ContactPair<Dim>, pairs_of(most_fields)> pairs_;
  std::array<std::pair<int, int>, pairs_of(most_fields)> bodies_;
  int count_ = 0;
};

}  // namespace tailrun::mpm

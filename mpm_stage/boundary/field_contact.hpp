// Contact between the velocity fields at one node (Bardenhagen, Brackbill & Sulsky 2000, with other normals and another
// strength).
//
// phi = 0 soil does not slide on stronger soil beside it as long as both share a velocity: it sticks, shears inside
// itself over some three cells, and a slide's length depends on the cell. With a velocity of its own it slides as soon
// as the shear stress reaches what it carries.
//
// Bodies i and j at a node, with velocities after forces and body acceleration and n from the centre of i to that of j:
// the approach (v_i - v_j) . n is stopped, their sliding is braked (field_friction.hpp) by at most
//   min(dt A min(s_i, s_j), mu J)
// where A is the part of the surface that is the node's (the larger of the two bodies' G . n, interface_sums.hpp:
// beside a layer thinner than the node's reach, only the other one shows it whole), s the shear stress that the soil
// carries and J the normal impulse. Impulses act on both, so momentum is exact, and each takes kinetic energy.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mpm_stage/boundary/field_friction.hpp"
#include "mpm_stage/boundary/half_spaces.hpp"
#include "mpm_stage/grid/field_choice.hpp"
#include "mpm_stage/material/soil_limit.hpp"
#include "mpm_stage/transfer/interface_sums.hpp"

namespace tailrun::mpm {

enum class Opening { free, held };

struct FieldContactLaw {
  // 1, of the normal impulse; negative: what holds is the strength of the weaker soil alone.
  double friction = -1.0;
  Opening opening = Opening::free;
};

// Cells: centres that are farther apart than those of touching half-spaces by more than this have a gap between them.
// Particles are no continuum: the centres of soil that touches scatter by about half of it.
constexpr double open_gap = 0.15;

// Cells: a body whose centre lies farther from the node is there with the rim of its reach alone; that of a half-space
// whose surface is 0.7 cells away lies there.
constexpr double rim = 0.9;

// plainness() of what is no corner and no thin plate is more; a surface that wobbles by up to 20 deg has 0.98.
constexpr double least_plainness = 0.9;

// The surface of a field at a node and those around it: sums of G and of its size, nearer nodes counting more. A single
// node's G wobbles with the particles' places, and bodies would slide as over a washboard: a slab of soft clay on a
// plane of firm particles, at 8 degrees to the grid, three quarters as far as along it.
template <int Dim>
struct SurfaceAround {
  std::array<double, Dim> outward{};  // m2
  double faces = 0.0;                 // m2
};

// One field, or several that move as one, at a node.
template <int Dim>
struct BodyAtNode {
  using Vector = std::array<double, Dim>;
  double mass = 0.0;      // kg
  Vector v{}, before{};   // m/s, after forces; at the step's start
  double volume = 0.0;    // m3
  Vector centre{};        // m, from the node
  Vector surface{};       // m2, G
  Vector outward{};       // m2, sum of G of the nodes around: the direction that the surface faces
  double faces = 0.0;     // m2, sum of their |G|
  double strength = 0.0;  // Pa
  bool firm = false;      // soil that does not flow: its particles show its surface best

  // 1 where the surface around the node is a plane, less at corners (0.7 where it turns by 90 deg) and of thin plates.
  double plainness() const {
    double square = 0.0;
    for (const double x : outward) square += x * x;
    return faces > 0.0 ? std::sqrt(square) / faces : 0.0;
  }
  void add(const BodyAtNode& o) {
    const double m = mass + o.mass, V = volume + o.volume;
    for (int d = 0; d < Dim; ++d) {
      v[d] = (mass * v[d] + o.mass * o.v[d]) / m;
      before[d] = (mass * before[d] + o.mass * o.before[d]) / m;
      centre[d] = (volume * centre[d] + o.volume * o.centre[d]) / V;
      surface[d] += o.surface[d];
      outward[d] += o.outward[d];
    }
    faces += o.faces;
    strength = (volume * strength + o.volume * o.strength) / V;
    mass = m;
    volume = V;
  }
};

template <int Dim>
BodyAtNode<Dim> body_at_node(double mass, const InterfaceNode& sums, const SurfaceAround<Dim>& around) {
  BodyAtNode<Dim> body;
  body.mass = mass;
  body.volume = sums.first[0];
  body.strength = sums.second[0] / body.volume;
  body.faces = around.faces;
  for (int d = 0; d < Dim; ++d) {
    body.centre[d] = sums.first[1 + d] / body.volume;
    body.surface[d] = sums.second[1 + d];
    body.outward[d] = around.outward[d];
  }
  return body;
}

// What contact does between two bodies of a node, worked out once and used in each round.
template <int Dim>
class ContactPair {
 public:
  using Vector = std::array<double, Dim>;

  ContactPair() = default;
  // `h` is the cell (m).
  template <class Shape>
  ContactPair(BodyAtNode<Dim>& i, BodyAtNode<Dim>& j, const FieldContactLaw& law, double h, double dt,
              const HalfSpaces<Shape>& half)
      : i_(&i), j_(&j), law_(law), reduced_(i.mass * j.mass / (i.mass + j.mass)) {
    double distance = 0.0;
    for (int d = 0; d < Dim; ++d) n_[d] = j.centre[d] - i.centre[d];
    distance = std::sqrt(along<Dim>(n_, n_));
    // Soils mixed through each other have no surface between them and move as one.
    mixed_ = distance < 0.02 * h;
    if (mixed_) return;
    for (double& x : n_) x /= distance;
    // Soil that flows opens and crowds, and its centre with it: soil that does not shows the surface better, of two
    // such bodies the one whose surface is the plainer (a corner of the other is none).
    const bool of_i = i.firm && (!j.firm || i.plainness() >= j.plainness());
    // Beside soil that flows, firm layers are often thinner than the nodes around reach, which would tilt them.
    const BodyAtNode<Dim>& shows = of_i ? i : j;
    if (shows.firm)
      take_normal_of((i.firm && j.firm) || shows.plainness() > least_plainness ? shows.outward : shows.surface,
                     of_i ? 1.0 : -1.0);
    // Inside soil that flows, the node's velocity differs from that of the surface by what the soil strains in between;
    // what is there of the firm body is the rim of its reach, and must not be taken along.
    if (i.firm != j.firm) presses_ = std::fabs(along<Dim>(i.firm ? i.centre : j.centre, n_)) <= rim * h;
    const double gap = distance - h * half.centres_apart(j.volume / (i.volume + j.volume)) - open_gap * h;
    touches_ = gap <= 0.0 || law.opening == Opening::held;
    allowed_ = touches_ ? 0.0 : gap / dt;
    const double area = surface_of_both(half, h);
    const double strength = std::min(i.strength, j.strength);
    cohesive_ = strength < no_soil_limit ? dt * area * strength : no_soil_limit;
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
  // Its surface over that of a half-space with its share of the node: 1, less at corners and of thin plates.
  template <class Shape>
  static double flatness(const BodyAtNode<Dim>& body, const HalfSpaces<Shape>& half, double h) {
    double cell = 1.0;
    for (int d = 0; d < Dim; ++d) cell *= h;
    const double slice = half.slice(body.volume / cell) * cell / h;
    return slice > 0.0 ? std::sqrt(along<Dim>(body.surface, body.surface)) / slice : 0.0;
  }
  void take_normal_of(const Vector& surface, double sign) {
    const double size = std::sqrt(along<Dim>(surface, surface));
    if (sign * along<Dim>(surface, n_) <= 0.5 * size) return;
    for (int d = 0; d < Dim; ++d) n_[d] = sign * surface[d] / size;
  }
  // m2, of the surface between the bodies that is the node's. Where one of them is soil that does not flow, its
  // particles show it best, unless it is a plate so thin that the node sees its other surface, too.
  template <class Shape>
  double surface_of_both(const HalfSpaces<Shape>& half, double h) const {
    const double of_i = std::max(0.0, along<Dim>(i_->surface, n_)), of_j = std::max(0.0, -along<Dim>(j_->surface, n_));
    if (i_->firm != j_->firm && flatness(i_->firm ? *i_ : *j_, half, h) > 0.7) return i_->firm ? of_i : of_j;
    return std::max(of_i, of_j);
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
  bool mixed_ = false, presses_ = true, touches_ = false;
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

// Whether `weak` lies between the bodies a and b.
template <int Dim>
bool lies_between(const BodyAtNode<Dim>& weak, const BodyAtNode<Dim>& a, const BodyAtNode<Dim>& b) {
  double product = 0.0;
  for (int d = 0; d < Dim; ++d) product += (a.centre[d] - weak.centre[d]) * (b.centre[d] - weak.centre[d]);
  return product < 0.0;
}

}  // namespace tailrun::mpm

// Where two bodies meet at a node: found from the sums of interface_sums.hpp when these are (SurfaceAge), and used in
// each step until then by what moves (field_contact.hpp).
//
// The surface's normal n goes from the centre of body i to that of j unless soil that does not flow shows the surface
// better. Its area is the part of it that is the node's: the larger of the two bodies' G . n, for beside a layer
// thinner than the node's reach, only the other one shows it whole. Of that counts what the other body lies on: beyond
// a slab's end the bed shows its surface as well.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "mpm_stage/boundary/field_friction.hpp"
#include "mpm_stage/boundary/half_spaces.hpp"
#include "mpm_stage/transfer/interface_sums.hpp"

namespace tailrun::mpm {

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

// What is known of one field, or several that move as one, at a node.
template <int Dim>
struct BodyShape {
  using Vector = std::array<double, Dim>;
  double volume = 0.0;                   // m3; 0: not known yet, for it has come since surfaces were found
  Vector centre{};                       // m, from the node
  Vector surface{};                      // m2, G
  Vector outward{};                      // m2, sum of G of the nodes around: the direction that the surface faces
  double faces = 0.0;                    // m2, sum of their |G|
  double strength = 0.0;                 // Pa
  std::array<std::uint32_t, 3> cover{};  // of the node's reach along each axis (InterfaceNode)
  bool firm = false;                     // soil that does not flow: its particles show its surface best

  // 1 where the surface around the node is a plane, less at corners (0.7 where it turns by 90 deg) and of thin plates.
  double plainness() const {
    double square = 0.0;
    for (const double x : outward) square += x * x;
    return faces > 0.0 ? std::sqrt(square) / faces : 0.0;
  }
  void add(const BodyShape& o) {
    const double V = volume + o.volume;
    if (!(V > 0.0)) return;
    for (int d = 0; d < Dim; ++d) {
      centre[d] = (volume * centre[d] + o.volume * o.centre[d]) / V;
      surface[d] += o.surface[d];
      outward[d] += o.outward[d];
    }
    for (std::size_t d = 0; d < cover.size(); ++d) cover[d] |= o.cover[d];
    faces += o.faces;
    strength = (volume * strength + o.volume * o.strength) / V;
    volume = V;
  }
};

template <int Dim>
BodyShape<Dim> body_shape(const InterfaceNode& sums, const SurfaceAround<Dim>& around) {
  BodyShape<Dim> body;
  if (!(sums.first[0] > 0.0)) return body;
  body.volume = sums.first[0];
  body.strength = sums.second[0] / body.volume;
  body.faces = around.faces;
  body.cover = sums.cover;
  for (int d = 0; d < Dim; ++d) {
    body.centre[d] = sums.first[1 + d] / body.volume;
    body.surface[d] = sums.second[1 + d];
    body.outward[d] = around.outward[d];
  }
  return body;
}

// Whether `weak` lies between the bodies a and b, as far as is known.
template <int Dim>
bool lies_between(const BodyShape<Dim>& weak, const BodyShape<Dim>& a, const BodyShape<Dim>& b) {
  if (!(weak.volume > 0.0 && a.volume > 0.0 && b.volume > 0.0)) return false;
  double product = 0.0;
  for (int d = 0; d < Dim; ++d) product += (a.centre[d] - weak.centre[d]) * (b.centre[d] - weak.centre[d]);
  return product < 0.0;
}

// Between body i and body j.
template <int Dim>
class ContactSurface {
 public:
  using Vector = std::array<double, Dim>;

  ContactSurface() = default;
  // `h` is the cell (m).
  template <class Shape>
  ContactSurface(const BodyShape<Dim>& i, const BodyShape<Dim>& j, double h, const HalfSpaces<Shape>& half) {
    if (!(i.volume > 0.0 && j.volume > 0.0)) return;
    known_ = true;
    for (int d = 0; d < Dim; ++d) normal_[d] = j.centre[d] - i.centre[d];
    const double distance = std::sqrt(along<Dim>(normal_, normal_));
    mixed_ = distance < 0.02 * h;
    if (mixed_) return;
    for (double& x : normal_) x /= distance;
    // Soil that flows opens and crowds, and its centre with it: soil that does not shows the surface better, of two
    // such bodies the one whose surface is the plainer (a corner of the other is none).
    const bool of_i = i.firm && (!j.firm || i.plainness() >= j.plainness());
    // Beside soil that flows, firm layers are often thinner than the nodes around reach, which would tilt them.
    const BodyShape<Dim>& shows = of_i ? i : j;
    if (shows.firm)
      take_normal_of((i.firm && j.firm) || shows.plainness() > least_plainness ? shows.outward : shows.surface,
                     of_i ? 1.0 : -1.0);
    // Inside soil that flows, the node's velocity differs from that of the surface by what the soil strains in between;
    // what is there of the firm body is the rim of its reach, and must not be taken along.
    presses_ = i.firm == j.firm || std::fabs(along<Dim>(i.firm ? i.centre : j.centre, normal_)) <= rim * h;
    gap_ = distance - h * half.centres_apart(j.volume / (i.volume + j.volume)) - open_gap * h;
    strength_ = std::min(i.strength, j.strength);
    if (strength_ < no_soil_limit) area_ = surface_of_both(i, j, half, h);
  }

  bool known() const { return known_; }
  const Vector& normal() const { return normal_; }
  double gap() const { return gap_; }            // m, beyond what is none; negative: they touch
  double area() const { return area_; }          // m2
  double strength() const { return strength_; }  // Pa, of the weaker soil
  // Soils mixed through each other have no surface between them and move as one.
  bool mixed() const { return mixed_; }
  bool presses() const { return presses_; }

 private:
  // Its surface over that of a half-space with its share of the node: 1, less at corners and of thin plates.
  template <class Shape>
  static double flatness(const BodyShape<Dim>& body, const HalfSpaces<Shape>& half, double h) {
    double cell = 1.0;
    for (int d = 0; d < Dim; ++d) cell *= h;
    const double slice = half.slice(body.volume / cell) * cell / h;
    return slice > 0.0 ? std::sqrt(along<Dim>(body.surface, body.surface)) / slice : 0.0;
  }
  void take_normal_of(const Vector& surface, double sign) {
    const double size = std::sqrt(along<Dim>(surface, surface));
    if (sign * along<Dim>(surface, normal_) <= 0.5 * size) return;
    for (int d = 0; d < Dim; ++d) normal_[d] = sign * surface[d] / size;
  }
  // Share of the surface of `body` that `other` lies beside: how far it covers the node's reach along the surface
  // (along the axes nearest to that), over how far a half-space beyond a plane with this tilt would.
  template <class Shape>
  double share_beside(const BodyShape<Dim>& body, const BodyShape<Dim>& other, const HalfSpaces<Shape>& half,
                      double h) const {
    using Line = InterfaceNode::Line;
    // A corner that the plane hardly leaves has few bins, half of one is much of it: no more than `least` makes whole
    // (JUDGE).
    constexpr double reach = Line::reach, least = 0.2;
    int across = 0;
    double cell = 1.0, share = 1.0;
    for (int d = 0; d < Dim; ++d) {
      cell *= h;
      if (std::fabs(normal_[d]) > std::fabs(normal_[across])) across = d;
    }
    // The plane lies `offset` (cells) from the node; where it leaves the reach across the surface, nothing is beyond.
    const double offset = half.offset(body.volume / cell), room = reach * std::fabs(normal_[across]) - offset;
    for (int d = 0; d < Dim; ++d) {
      if (d == across) continue;
      const double tilt = std::fabs(normal_[d]);
      const double whole = reach * tilt > room ? 1.0 - spline_up_to(-room / tilt) : 1.0;
      const double covered = Line::share(Line::closed(other.cover[static_cast<std::size_t>(d)]));
      share *= std::min(1.0, covered / std::max(least, whole));
    }
    return share;
  }
  // m2, of the surface between the bodies that is the node's. Where one of them is soil that does not flow, its
  // particles show it best, unless it is a plate so thin that the node sees its other surface, too.
  template <class Shape>
  double surface_of_both(const BodyShape<Dim>& i, const BodyShape<Dim>& j, const HalfSpaces<Shape>& half,
                         double h) const {
    const double of_i = std::max(0.0, along<Dim>(i.surface, normal_)) * share_beside(i, j, half, h);
    const double of_j = std::max(0.0, -along<Dim>(j.surface, normal_)) * share_beside(j, i, half, h);
    if (i.firm != j.firm && flatness(i.firm ? i : j, half, h) > 0.7) return i.firm ? of_i : of_j;
    return std::max(of_i, of_j);
  }

  Vector normal_{};
  double gap_ = 0.0, area_ = 0.0, strength_ = 0.0;
  bool known_ = false, mixed_ = false, presses_ = false;
};

// The surfaces of a node that are known.
struct NodeMeeting {
  std::uint8_t fields = 0;    // that meet, as bits; 0: none are known
  bool sides_joined = false;  // the sides of one soil are one body, for no weak soil keeps them apart
};

}  // namespace tailrun::mpm

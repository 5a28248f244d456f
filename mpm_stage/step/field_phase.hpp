// What the velocity fields do to each other at the nodes that they share (boundary/field_contact.hpp); included by
// explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// Which fields have more than a trace of the mass at node n of active block a, as bits. Where a field has less,
// particles feel no more than that share of its velocity.
template <int Dim, class Shape, bool Split, TransferName Transfer>
unsigned ExplicitSolver<Dim, Shape, Split, Transfer>::fields_at(std::size_t a, int n, const NodeSums* node) const {
  constexpr double trace = 1e-7;
  double mass = 0.0;
  for (int f = 0; f < fields_.count(); ++f)
    if (fields_.present(f, a)) mass += node[f].sum[n][0];
  unsigned there = 0;
  for (int f = 0; f < fields_.count(); ++f)
    if (fields_.present(f, a) && node[f].sum[n][0] > std::max(mass_cutoff_, trace * mass)) there |= 1U << f;
  return there;
}

// Where the bodies at a node with the fields `there` meet, as long as the surfaces are as old as they are (SurfaceAge).
template <int Dim, class Shape, bool Split, TransferName Transfer>
NodeMeeting ExplicitSolver<Dim, Shape, Split, Transfer>::meeting_at(std::size_t a, int n, unsigned there) {
  NodeMeeting& known = known_meeting_[known_of(a) + static_cast<std::size_t>(n)];
  if (known.fields != there) known = find_meeting(a, n, there);
  return known;
}

// Sides of one soil that no weak soil keeps apart move as one.
template <int Dim, class Shape, bool Split, TransferName Transfer>
NodeMeeting ExplicitSolver<Dim, Shape, Split, Transfer>::find_meeting(std::size_t a, int n, unsigned there) {
  std::array<BodyShape<Dim>, most_fields> shape;  // by field
  for (int f = 0; f < fields_.count(); ++f) {
    if (!(there >> f & 1U)) continue;
    const bool firm = options_.fields.firm(f);
    shape[f] = body_shape<Dim>(interfaces_[interface_of(f, a) + static_cast<std::size_t>(n)],
                               firm ? surface_around(f, a, n) : SurfaceAround<Dim>{});
    shape[f].firm = firm;
  }
  NodeMeeting meeting{.fields = static_cast<std::uint8_t>(there)};
  if (options_.fields.by_side && there == 0b111U && !lies_between(shape[1], shape[0], shape[2])) {
    shape[0].add(shape[2]);
    meeting.sides_joined = true;
  }
  for (int i = 0; i < fields_.count(); ++i)
    for (int j = i + 1; j < fields_.count(); ++j)
      if ((there >> i & 1U) && (there >> j & 1U))
        contact_surface_[grip_of(pair_of(i, j, fields_.count()), a) + static_cast<std::size_t>(n)] =
            ContactSurface<Dim>(shape[i], shape[j], h_, half_spaces_);
  return meeting;
}

// The bodies at a node where fields meet.
template <int Dim, class Shape, bool Split, TransferName Transfer>
typename ExplicitSolver<Dim, Shape, Split, Transfer>::NodeBodies ExplicitSolver<Dim, Shape, Split, Transfer>::bodies_at(
    std::size_t a, int n, const NodeMeeting& meeting, const NodeSums* node) const {
  NodeBodies bodies;
  for (int f = 0; f < fields_.count(); ++f) {
    if (!(meeting.fields >> f & 1U)) continue;
    BodyAtNode<Dim> body;
    body.mass = node[f].sum[n][0];
    set_motion(node_of(f, a) + static_cast<std::size_t>(n), body);
    if (meeting.sides_joined && f == 2) {
      bodies.body[0].add(body);
      bodies.of_field[2] = 0;
      continue;
    }
    bodies.body[bodies.count] = body;
    bodies.field[bodies.count] = f;
    bodies.of_field[f] = bodies.count++;
  }
  return bodies;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::set_motion(std::size_t node, BodyAtNode<Dim>& body) const {
  body.v = body.before = velocity_at(node);
  if constexpr (Split)
    for (int d = 0; d < Dim; ++d) body.before[d] -= change_of(node, d);
}

// Both sides of one soil at a node that no weak soil reaches go on as one field.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::join_sides(std::size_t a, int n, const NodeSums* node,
                                                             GridSums<Dim>& sums) {
  NodeBodies bodies;
  BodyAtNode<Dim> upper;
  bodies.count = 1;
  bodies.of_field[0] = bodies.of_field[2] = 0;
  bodies.body[0].mass = node[0].sum[n][0];
  upper.mass = node[2].sum[n][0];
  set_motion(node_of(0, a) + static_cast<std::size_t>(n), bodies.body[0]);
  set_motion(node_of(2, a) + static_cast<std::size_t>(n), upper);
  bodies.body[0].add(upper);
  take_over(a, n, node, bodies, sums);
}

// The contacts between the bodies of node n, at which the pairs point.
template <int Dim, class Shape, bool Split, TransferName Transfer>
ContactPairs<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::contact_pairs(std::size_t a, int n, NodeBodies& bodies,
                                                                             double dt) const {
  ContactPairs<Dim> pairs;
  for (int i = 0; i < bodies.count; ++i)
    for (int j = i + 1; j < bodies.count; ++j) {
      // Both sides of weak soil meet through it alone.
      if (options_.fields.by_side && i != bodies.of_field[1] && j != bodies.of_field[1]) continue;
      const int pair = pair_of(bodies.field[i], bodies.field[j], fields_.count());
      const ContactSurface<Dim>& surface = contact_surface_[grip_of(pair, a) + static_cast<std::size_t>(n)];
      pairs.add(ContactPair<Dim>(bodies.body[i], bodies.body[j], surface, options_.contact, dt), i, j);
    }
  return pairs;
}

// What brakes the pairs of node n, for rub_fields().
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::keep_grips(std::size_t a, int n, const NodeBodies& bodies,
                                                             const ContactPairs<Dim>& pairs) {
  std::array<unsigned, most_fields> of_body{};  // fields, as bits
  for (int f = 0; f < fields_.count(); ++f)
    if (bodies.of_field[f] >= 0) of_body[bodies.of_field[f]] |= 1U << f;
  for (int k = 0; k < pairs.count(); ++k) {
    FieldGrip<Dim> grip = pairs[k].grip();
    if (!grip.any()) continue;
    const auto [i, j] = pairs.bodies(k);
    grip.fields = {static_cast<std::uint8_t>(of_body[i]), static_cast<std::uint8_t>(of_body[j])};
    const int pair = pair_of(std::countr_zero(of_body[i]), std::countr_zero(of_body[j]), fields_.count());
    field_grip_[grip_of(pair, a) + static_cast<std::size_t>(n)] = grip;
    gripping_[grip_of(pair, a) / block_nodes] = 1;
  }
}

// Contact at the shared nodes of block a, with the ground, too, where it is near: `settled` gets the fields for which
// it is done.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::part_fields(std::size_t a, double dt, const NodeSums* node,
                                                              const NodeGaps* gap, NodeFields& settled,
                                                              GridSums<Dim>& sums) {
  constexpr unsigned both_sides = 0b101;
  const NodeContact* contact = ground_.of_block(a);
  std::uint8_t* meeting = meeting_.data() + a * block_nodes;
  for (int n = 0; n < block_nodes; ++n) {
    const unsigned there = fields_at(a, n, node);
    const bool several = (there & (there - 1U)) != 0, sides = options_.fields.by_side && there == both_sides;
    if (!several || sides)
      meeting[n] = not_met;
    else if (meeting[n] == not_met)
      meeting[n] = met;
    if (sides) join_sides(a, n, node, sums);
    if (meeting[n] != surface_known || in_body(a, n)) continue;
    NodeBodies bodies = bodies_at(a, n, meeting_at(a, n, there), node);
    auto pairs = contact_pairs(a, n, bodies, dt);
    if (contact && contact[n].count > 0) {
      settled[n] = static_cast<std::uint8_t>(there);
      settle_on_ground(a, n, dt, node, gap, contact[n], bodies, pairs, sums);
    } else {
      settle(pairs);
    }
    keep_grips(a, n, bodies, pairs);
    take_over(a, n, node, bodies, sums);
  }
}

// The fields' velocities from those of the bodies that they belong to.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::take_over(std::size_t a, int n, const NodeSums* node,
                                                            const NodeBodies& bodies, GridSums<Dim>& sums) {
  for (int f = 0; f < fields_.count(); ++f) {
    const int b = bodies.of_field[f];
    if (b < 0) continue;
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    if constexpr (Split) {
      // Sides that move as one are one field here: the difference of their velocities is no motion of the grid.
      std::array<double, Dim> own = velocity_at(k), before = own;
      for (int d = 0; d < Dim; ++d) before[d] -= change_of(k, d);
      const double m = node[f].sum[n][0];
      sums.kinetic_before += 0.5 * m * (square<Dim>(bodies.body[b].before) - square<Dim>(before));
      sums.kinetic_after += 0.5 * m * (square<Dim>(bodies.body[b].v) - square<Dim>(own));
    }
    set_velocity(k, bodies.body[b].v, bodies.body[b].before);
  }
}

// The contacts between the bodies of node n and of each with the ground; leaves the ground's push in grip_.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::settle_on_ground(std::size_t a, int n, double dt,
                                                                   const NodeSums* node, const NodeGaps* gap,
                                                                   const NodeContact& contact, NodeBodies& bodies,
                                                                   ContactPairs<Dim>& pairs, GridSums<Dim>& sums) {
  std::array<double, most_fields> clearance;
  clearance.fill(no_gap_known);
  for (int f = 0; f < fields_.count(); ++f)
    if (const int b = bodies.of_field[f]; b >= 0) clearance[b] = std::min(clearance[b], (*gap[f])[n].value);
  std::array<GroundPush<Dim>, most_fields> ground;
  for (int b = 0; b < bodies.count; ++b)
    ground[b] = GroundPush<Dim>(contact, bodies.body[b].mass, std::max(0.0, clearance[b]) / dt);
  settle(pairs, bodies.body.data(), ground.data(), bodies.count);
  for (int b = 0; b < bodies.count; ++b)
    for (int d = 0; d < Dim; ++d) sums.impulse[d] += ground[b].impulse()[d];
  for (int f = 0; f < fields_.count(); ++f) {
    const int b = bodies.of_field[f];
    if (b < 0) continue;
    // Fields that move as one share the push by their masses.
    NodeGrip& grip = grip_[node_of(f, a) + static_cast<std::size_t>(n)] = ground[b].grip();
    const double share = node[f].sum[n][0] / bodies.body[b].mass;
    grip.mass *= share;
    grip.friction *= share;
  }
}

}  // namespace tailrun::mpm

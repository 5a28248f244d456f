// What the velocity fields do to each other at the nodes that they share (boundary/field_contact.hpp); included by
// explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// The surfaces of the materials in block b, for contact.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_interfaces(std::size_t b) {
  int field = -1;
  for (const Run& run : grid_.runs(b)) {
    InterfaceNode* tile = interface_tiles_.data() + fields_.tile(run.field, b) * tile_nodes;
    if (run.field != field) std::fill_n(tile, tile_nodes, InterfaceNode{});
    field = run.field;
    scatter_interface<Dim, Shape>(constants_[run.material], P_, run.begin, run.end, corner(b), h1_, tile);
  }
}

// The bodies at a node: fields with mass there; sides of one soil that no weak soil keeps apart move as one.
template <int Dim, class Shape, bool Split, TransferName Transfer>
typename ExplicitSolver<Dim, Shape, Split, Transfer>::NodeBodies ExplicitSolver<Dim, Shape, Split, Transfer>::bodies_at(
    std::size_t a, int n, const NodeSums* node, const InterfaceNode (*surface)[block_nodes]) const {
  // Where a field has less than this share of the mass, particles feel no more than that share of its velocity.
  constexpr double trace = 1e-7;
  NodeBodies bodies;
  double mass = 0.0;
  for (int f = 0; f < fields_.count(); ++f)
    if (fields_.present(f, a)) mass += node[f].sum[n][0];
  if (mass <= mass_cutoff_) return bodies;
  for (int f = 0; f < fields_.count(); ++f) {
    if (!fields_.present(f, a)) continue;
    const double m = node[f].sum[n][0];
    if (m <= mass_cutoff_ || m <= trace * mass) continue;
    BodyAtNode<Dim> body = body_at_node<Dim>(m, surface[f][n]);
    body.firm = options_.fields.firm(f);
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    body.v = velocity_at(k);
    if constexpr (Split)
      for (int d = 0; d < Dim; ++d) body.before[d] = body.v[d] - change_of(k, d);
    bodies.of_field[f] = bodies.count;
    bodies.body[bodies.count++] = body;
  }
  const int lower = bodies.of_field[0], weak = bodies.of_field[1], upper = bodies.of_field[2];
  if (options_.fields.by_side && lower >= 0 && upper >= 0 &&
      (weak < 0 || !lies_between(bodies.body[weak], bodies.body[lower], bodies.body[upper]))) {
    bodies.body[lower].add(bodies.body[upper]);
    bodies.of_field[2] = lower;
    --bodies.count;  // the upper side is the last one
  }
  return bodies;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::load_interfaces(std::size_t a,
                                                                  InterfaceNode (*surface)[block_nodes]) const {
  for (int f = 0; f < fields_.count(); ++f)
    if (fields_.present(f, a))
      gather_tiles<Dim, Shape>(fields_.around(f, a), interface_tiles_.data() + fields_.tile(f, 0) * tile_nodes,
                               surface[f]);
}

// The contacts between the bodies of a node, at which the pairs point.
template <int Dim, class Shape, bool Split, TransferName Transfer>
ContactPairs<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::contact_pairs(NodeBodies& bodies, double dt) const {
  ContactPairs<Dim> pairs;
  for (int i = 0; i < bodies.count; ++i)
    for (int j = i + 1; j < bodies.count; ++j) {
      // Both sides of weak soil meet through it alone.
      if (options_.fields.by_side && i != bodies.of_field[1] && j != bodies.of_field[1]) continue;
      pairs.add(ContactPair<Dim>(bodies.body[i], bodies.body[j], options_.contact, h_, dt, half_spaces_));
    }
  return pairs;
}

// Contact at the shared nodes of block a.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::part_fields(std::size_t a, double dt, const NodeSums* node,
                                                              GridSums<Dim>& sums) {
  // A light layer between heavy bodies passes on little with each round.
  constexpr int most_rounds = 30;
  constexpr double little = 1e-6;
  InterfaceNode surface[most_fields][block_nodes];
  load_interfaces(a, surface);
  for (int n = 0; n < block_nodes; ++n) {
    NodeBodies bodies = bodies_at(a, n, node, surface);
    if (bodies.count == 0) continue;
    auto pairs = contact_pairs(bodies, dt);
    double first = 0.0, change = 0.0;
    for (int round = 0; round < most_rounds; ++round) {
      change = 0.0;
      for (ContactPair<Dim>& pair : pairs) change += pair.press();
      if (round == 0) first = change;
      if (pairs.count() < 2 || change <= little * first) break;
    }
    for (ContactPair<Dim>& pair : pairs) sums.contact += pair.rub();
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

// Where one of two fields that touch rests on the ground it cannot give way, and passes on what presses it there. Both
// contacts are taken in turn; each takes energy, so that what is left after the last round is harmless.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::settle_on_ground(std::size_t a, double dt, const NodeSums* node,
                                                                   GridSums<Dim>& sums) {
  constexpr int most_rounds = 20;
  const NodeContact* contact = ground_.of_block(a);
  InterfaceNode surface[most_fields][block_nodes];
  bool loaded = false;
  for (int n = 0; n < block_nodes; ++n) {
    if (contact[n].count == 0) continue;
    int present = 0, resting = 0;
    for (int f = 0; f < fields_.count(); ++f) {
      if (!fields_.present(f, a) || node[f].sum[n][0] <= mass_cutoff_) continue;
      ++present;
      resting += grip_[node_of(f, a) + static_cast<std::size_t>(n)].pushed ? 1 : 0;
    }
    if (resting == 0 || present < 2) continue;
    if (!loaded) load_interfaces(a, surface);
    loaded = true;
    NodeBodies bodies = bodies_at(a, n, node, surface);
    if (bodies.count < 2) continue;
    std::array<bool, most_fields> rests{};
    std::array<double, most_fields> capacity{};
    for (int f = 0; f < fields_.count(); ++f)
      if (bodies.of_field[f] >= 0 && grip_[node_of(f, a) + static_cast<std::size_t>(n)].pushed)
        rests[bodies.of_field[f]] = true;
    const NodeBodies free = bodies;
    auto pairs = contact_pairs(bodies, dt);
    for (int round = 0; round < most_rounds; ++round) {
      double change = 0.0;
      for (ContactPair<Dim>& pair : pairs) change += pair.press();
      if (change <= 0.0) break;
      for (int b = 0; b < bodies.count; ++b)
        if (rests[b])
          capacity[b] += stop_approach<Dim>(contact[n], bodies.body[b].mass, 0.0, bodies.body[b].v).capacity;
    }
    for (int f = 0; f < fields_.count(); ++f) {
      const int b = bodies.of_field[f];
      if (b < 0) continue;
      NodeGrip& grip = grip_[node_of(f, a) + static_cast<std::size_t>(n)];
      const double m = node[f].sum[n][0];
      if (grip.pushed) grip.capacity += capacity[b] * m / bodies.body[b].mass;
      for (int d = 0; d < Dim; ++d) sums.impulse[d] += m * (bodies.body[b].v[d] - free.body[b].v[d]);
    }
    take_over(a, n, node, bodies, sums);
  }
}

}  // namespace tailrun::mpm

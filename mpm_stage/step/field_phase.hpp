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

// Contact at the shared nodes of block a.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::part_fields(std::size_t a, double dt, const NodeSums* node,
                                                              GridSums<Dim>& sums) {
  InterfaceNode surface[most_fields][block_nodes];
  for (int f = 0; f < fields_.count(); ++f)
    if (fields_.present(f, a))
      gather_tiles<Dim, Shape>(fields_.around(f, a), interface_tiles_.data() + fields_.tile(f, 0) * tile_nodes,
                               surface[f]);
  const auto book_sliding = [&sums](double work) {
    sums.contact += work;
    sums.impact -= work;  // of what take_over books there as a whole
  };
  for (int n = 0; n < block_nodes; ++n) {
    NodeBodies bodies = bodies_at(a, n, node, surface);
    if (bodies.count == 0) continue;
    const NodeBodies free = bodies;
    if (bodies.count == 2) {
      ContactPair<Dim> pair(bodies.body[0], bodies.body[1], options_.contact, h_, dt, half_spaces_);
      pair.press();
      book_sliding(pair.rub());
    } else if (bodies.count > 2) {
      std::array<std::optional<ContactPair<Dim>>, most_fields*(most_fields - 1) / 2> pairs;
      int count = 0;
      for (int i = 0; i < bodies.count; ++i)
        for (int j = i + 1; j < bodies.count; ++j) {
          // Both sides of weak soil meet through it alone.
          if (options_.fields.by_side && i != bodies.of_field[1] && j != bodies.of_field[1]) continue;
          pairs[count++].emplace(bodies.body[i], bodies.body[j], options_.contact, h_, dt, half_spaces_);
        }
      // A light layer between heavy bodies passes on little with each round.
      double first = 0.0, change = 0.0;
      for (int round = 0; round < 30; ++round) {
        change = 0.0;
        for (int k = 0; k < count; ++k) change += pairs[k]->press();
        if (round == 0) first = change;
        if (change <= 1e-6 * first) break;
      }
      for (int k = 0; k < count; ++k) book_sliding(pairs[k]->rub());
    }
    take_over(a, n, node, bodies, free, sums);
  }
}

// The fields' velocities from those of the bodies that they belong to; `free` is how these were before contact.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::take_over(std::size_t a, int n, const NodeSums* node,
                                                            const NodeBodies& bodies, const NodeBodies& free,
                                                            GridSums<Dim>& sums) {
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
  if constexpr (Split)
    for (int b = 0; b < bodies.count; ++b) {
      const auto &v = bodies.body[b].v, &pushed = free.body[b].v;
      for (int d = 0; d < Dim; ++d)
        sums.impact -= 0.5 * bodies.body[b].mass * (v[d] - pushed[d]) * (bodies.body[b].before[d] + v[d]);
    }
}

// Where one of two fields that touch rests on the ground, the other cannot push it away.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::settle_on_ground(std::size_t a, double dt, const NodeSums* node,
                                                                   GridSums<Dim>& sums) {
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
    if (resting == 0 || resting == present) continue;
    if (!loaded)
      for (int f = 0; f < fields_.count(); ++f)
        if (fields_.present(f, a))
          gather_tiles<Dim, Shape>(fields_.around(f, a), interface_tiles_.data() + fields_.tile(f, 0) * tile_nodes,
                                   surface[f]);
    loaded = true;
    NodeBodies bodies = bodies_at(a, n, node, surface);
    for (int f = 0; f < fields_.count(); ++f)
      if (bodies.of_field[f] >= 0 && grip_[node_of(f, a) + static_cast<std::size_t>(n)].pushed)
        bodies.body[bodies.of_field[f]].on_ground = true;
    const NodeBodies free = bodies;
    for (int i = 0; i < bodies.count; ++i)
      for (int j = i + 1; j < bodies.count; ++j)
        ContactPair<Dim>(bodies.body[i], bodies.body[j], options_.contact, h_, dt, half_spaces_).press_onto_ground();
    // Nor is the other pushed into the ground.
    for (int b = 0; b < bodies.count; ++b) {
      const double approach = -along_normal(contact[n], free.body[b].v);
      stop_approach<Dim>(contact[n], bodies.body[b].mass, std::max(0.0, approach), bodies.body[b].v);
    }
    for (int f = 0; f < fields_.count(); ++f) {
      const int b = bodies.of_field[f];
      if (b < 0) continue;
      NodeGrip& grip = grip_[node_of(f, a) + static_cast<std::size_t>(n)];
      if (grip.pushed)
        grip.capacity +=
            contact[n].point[0].friction * bodies.body[b].ground_push * node[f].sum[n][0] / bodies.body[b].mass;
      for (int d = 0; d < Dim; ++d) sums.impulse[d] += node[f].sum[n][0] * (bodies.body[b].v[d] - free.body[b].v[d]);
    }
    take_over(a, n, node, bodies, free, sums);
  }
}

}  // namespace tailrun::mpm

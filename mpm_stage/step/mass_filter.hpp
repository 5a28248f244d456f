// FMPM(k): the nodes' velocities by an approximate inverse of the full mass matrix M instead of its row sums m
// (Hammerquist & Nairn 2017; Nairn & Hammerquist 2021). With v(1) = p / m
//   v(k) = sum_{l=0}^{k-1} (I - m^-1 M)^l v(1),
// of which k - 1 terms are made here. Particles take v(k) and its gradient and move with it.
//
// Nodes that walls, ground or bodies hold: v(1) is what contact has made of it, and each further term loses its part
// along the held directions (held_directions.hpp), so the series inverts the mass matrix of the free directions.
// Where velocity fields meet they share of each term what contact between them has settled: it must stay so.
// Mirrors and continued surface nodes treat M v like any other momentum.
//
// The time step: with mu in [0, 1] an eigenvalue of m^-1 M, the filter multiplies accelerations by
// (1 - (1 - mu)^k) / mu <= k, and all its factors are symmetric in the product with m. So the largest eigenvalue of the
// step grows at most k times, and steps of 1 / sqrt(k) of those that are stable for k = 1 are stable (explicit
// viscosity: 1 / k). Modes that particles hardly feel, such as a node's with a particle at the rim of its reach, come
// close to k.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::filter_velocity(double dt) {
  if (options_.fmpm_order < 2) return;
  const auto since = Clock::now();
  const auto complete = [this](AlignedVector<Vec4>& velocity) {
    for (int f = 0; f < fields_.count(); ++f) {
      Vec4* of_field = velocity.data() + node_of(f, 0);
      if (mirrors_.any()) mirrors_.reflect(of_field);
      if (!extension_.active()) continue;
      extension_.extend(of_field);
      if (mirrors_.any()) mirrors_.reflect(of_field);
    }
  };
  const auto for_each_block = [this](auto action) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a)
      for (int f = 0; f < fields_.count(); ++f)
        if (fields_.present(f, a)) action(f, a);
  };
  std::fill(grid_sums_.begin(), grid_sums_.end(), GridSums<Dim>{});
  std::copy(velocity_.begin(), velocity_.end(), term_.begin());
  if (fields_.several()) contact_velocity_.assign(velocity_.begin(), velocity_.end());
  for_each_block([&](int f, std::size_t a) { find_held(f, a, dt); });
  for (int l = 1; l < options_.fmpm_order; ++l) {
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t b = 0; b < grid_.occupied(); ++b)
      fields_.for_each_span(b, [&](const FieldSpan& span) {
        Vec4 velocity[tile_nodes];
        load_tile<Dim, Shape>(grid_, b, term_.data() + node_of(span.field, 0), velocity);
        // The tiles are free between the nodes' sums and the next P2G.
        Vec4* momentum = tiles_.data() + fields_.tile(span.field, b) * tile_nodes;
        std::fill(momentum, momentum + tile_nodes, Vec4{});
        apply_mass_matrix<Shape>(h1_, corner(b), P_, span.begin, span.end, velocity, momentum);
      });
    for_each_block([&](int f, std::size_t a) {
      gather_tiles<Dim, Shape>(fields_.around(f, a), tiles_of(f), products_.data() + node_of(f, a));
    });
    for (int f = 0; f < fields_.count(); ++f) {
      if (mirrors_.any()) mirrors_.fold(products_.data() + node_of(f, 0));
      if (extension_.active()) extension_.fold_force(sums_.data() + node_of(f, 0), products_.data() + node_of(f, 0));
    }
    for_each_block([&](int f, std::size_t a) { take_increment(f, a); });
    if (fields_.several()) share_increments();
    for (const auto& [k, b] : nodes_in_bodies_) {
      for (int d = 0; d < Dim; ++d) {
        const double taken = -sums_[k][0] * term_[k][d];
        bodies_[b].impulse[d] -= taken;
        work_.external += taken * body_velocity_[b][d];
      }
      term_[k] = Vec4{};
    }
    complete(term_);
#pragma omp parallel for schedule(static)
    for (std::size_t k = 0; k < velocity_.size(); ++k) velocity_[k] += term_[k];
  }
  if (ground_.any()) {
    for_each_block([&](int f, std::size_t a) { keep_contact(f, a); });
    for (const auto& [k, b] : nodes_in_bodies_) velocity_[k] = node_velocity<Dim>(body_velocity_[b].data());
    complete(velocity_);
  }
  for (const auto& s : grid_sums_) {
    work_.friction += s.friction;
    work_.contact += s.contact;
    for (int d = 0; d < Dim; ++d) impulse_[d] += s.impulse[d];
  }
  add_time(seconds_.grid, since);
}

// What contact between fields holds stays held: fields that contact has left with one velocity at a node get the term
// of all of them together, and two that touch and slide that part of it that lies across their surface. Momentum is
// kept.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::share_increments() {
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    if (!fields_.shared(a)) continue;
    for (int n = 0; n < block_nodes; ++n) {
      unsigned there = 0;
      for (int f = 0; f < fields_.count(); ++f)
        if (fields_.present(f, a) && sums_[node_of(f, a) + static_cast<std::size_t>(n)][0] > mass_cutoff_)
          there |= 1U << f;
      if ((there & (there - 1)) != 0) share_increments_at(a, n, there);
    }
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::share_increments_at(std::size_t a, int n, unsigned there) {
  const double slack = 1e-12 * fastest_wave_;
  const auto node = [&](int f) { return node_of(f, a) + static_cast<std::size_t>(n); };
  // Fields by the velocity that contact has left them with.
  unsigned left = there;
  while (left != 0) {
    const int first = std::countr_zero(left);
    unsigned alike = 0;
    Vec4 momentum = {};
    double mass = 0.0;
    for (int f = first; f < fields_.count(); ++f) {
      if (!(left >> f & 1U)) continue;
      double apart = 0.0;
      for (int d = 0; d < Dim; ++d)
        apart = std::max(apart, std::fabs(contact_velocity_[node(f)][d] - contact_velocity_[node(first)][d]));
      if (apart > slack) continue;
      alike |= 1U << f;
      momentum += term_[node(f)] * splat(sums_[node(f)][0]);
      mass += sums_[node(f)][0];
    }
    for (int f = first; f < fields_.count(); ++f)
      if (alike >> f & 1U) term_[node(f)] = momentum * splat(1.0 / mass);
    left &= ~alike;
  }
  for (int pair = 0; pair < pairs_of(fields_.count()); ++pair) {
    const std::size_t first = grip_of(pair, a);
    if (!gripping_[first / block_nodes]) continue;
    const FieldGrip<Dim>& grip = field_grip_[first + static_cast<std::size_t>(n)];
    if (!grip.any()) continue;
    const std::size_t k[2] = {node(std::countr_zero(grip.fields[0])), node(std::countr_zero(grip.fields[1]))};
    double across = 0.0, parting = 0.0;
    for (int d = 0; d < Dim; ++d) {
      across += (term_[k[1]][d] - term_[k[0]][d]) * grip.normal[d];
      parting += (contact_velocity_[k[1]][d] - contact_velocity_[k[0]][d]) * grip.normal[d];
    }
    if (std::fabs(parting) > slack) continue;
    for (int side = 0; side < 2; ++side)
      for (int f = 0; f < fields_.count(); ++f)
        for (int d = 0; d < Dim && (grip.fields[side] >> f & 1U); ++d)
          term_[node(f)][d] += (side == 0 ? across : -across) * grip.reduced_mass() / grip.mass[side] * grip.normal[d];
  }
}

// The next term of field f's nodes in block a, (I - m^-1 M) times the one before.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::take_increment(int f, std::size_t a) {
  for (std::size_t k = node_of(f, a); k < node_of(f, a) + block_nodes; ++k) {
    const double m = sums_[k][0];
    term_[k] = m > mass_cutoff_ ? term_[k] - as_velocity<Dim>(products_[k]) * splat(1.0 / m) : Vec4{};
  }
  for (const HeldNode& node : held_nodes_[fields_.number(f, a)]) {
    if (!node.held.any()) continue;
    const double m = sums_[node.node][0];
    std::array<double, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = term_[node.node][d];
    node.held.release(v);
    for (int d = 0; d < Dim; ++d) {
      grid_sums_[a].impulse[d] += m * (v[d] - term_[node.node][d]);
      term_[node.node][d] = v[d];
    }
  }
}

// Which of field f's nodes in block a touch ground or frictional walls, and what holds them there.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::find_held(int f, std::size_t a, double dt) {
  auto& found = held_nodes_[fields_.number(f, a)];
  found.clear();
  const NodeContact* contact = ground_.of_block(a);
  if (!contact && !wall_nodes_.any) return;
  const double slack = 1e-12 * fastest_wave_;
  Gap<Dim> gap[block_nodes];
  if (contact) gather_tiles<Dim, Shape>(fields_.around(f, a), gap_tiles_.data() + fields_.tile(f, 0) * tile_nodes, gap);
  for (int n = 0; n < block_nodes; ++n) {
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    if (sums_[k][0] <= mass_cutoff_ || in_body(a, n)) continue;
    std::array<double, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = velocity_[k][d];
    HeldNode node{k, {}, v, nullptr, 0.0};
    if (contact && contact[n].count > 0) {
      node.contact = contact + n;
      node.allowed = std::max(0.0, gap[n].value) / dt;
      hold_by_ground<Dim>(contact[n], grip_[k], node.allowed, slack, v, node.held);
    }
    if (wall_nodes_.any) hold_by_walls<Dim>(wall_nodes_, grid_.node_index(a, n), slack, v, node.held);
    if (node.contact || node.held.any()) found.push_back(node);
  }
}

// The filter must neither push nodes that were leaving the ground into it nor make those that slid go back.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::keep_contact(int f, std::size_t a) {
  for (const HeldNode& node : held_nodes_[fields_.number(f, a)]) {
    if (!node.contact) continue;
    const double m = sums_[node.node][0];
    std::array<double, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = velocity_[node.node][d];
    stop_return<Dim>(grip_[node.node], node.before, v);
    stop_approach<Dim>(*node.contact, m, node.allowed, v);
    // Friction has been booked with the velocity before the filter; the one after it displaces.
    if (const NodeGrip& grip = grip_[node.node]; grip.mass > 0.0) {
      const double impulse = pooled_impulse<Dim>(ground_.contact_around(a), grip, spread_.data() + node_of(f, 0),
                                                 static_cast<int>(node.node % block_nodes));
      grid_sums_[a].friction += impulse * friction_path<Dim>(grip, node.before, v);
    }
    for (int d = 0; d < Dim; ++d) {
      grid_sums_[a].impulse[d] += m * (v[d] - velocity_[node.node][d]);
      velocity_[node.node][d] = v[d];
    }
  }
}

}  // namespace tailrun::mpm

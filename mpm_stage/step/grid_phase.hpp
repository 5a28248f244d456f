// The grid's part of a step, as explicit_solver.hpp runs it; included there. Block by block: sums, then velocities
// after forces, then what the fields do to each other, then ground and walls; afterwards what needs the whole grid.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::update_grid(double dt, const std::array<double, Dim>& body,
                                                              const std::array<double, Dim>& inertial) {
  const auto since = Clock::now();
  const Drive drive = drive_of(dt, body, inertial);
  if (needs_all_sums()) complete_sums();
  if (!bodies_.empty()) find_nodes_in_bodies(dt);
  if (fields_.several() && surface_age_.due()) {
    gather_interfaces();
    smooth_surfaces();
  }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid_.active(); ++a) grid_sums_[a] = still(a) ? rest_block(a) : move_block(a, drive);
  if (!bodies_.empty()) push_nodes(drive);
  if (fields_.several()) rub_fields(dt);
  if (ground_.any()) rub_ground(drive);
  continue_velocities();
  if constexpr (Split) {
    if (needs_all_sums()) sum_kinetic_after();
    if (options_.local_damping > 0.0) book_damping();
  }
  add_up();
  add_time(seconds_.grid, since);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
typename ExplicitSolver<Dim, Shape, Split, Transfer>::Drive ExplicitSolver<Dim, Shape, Split, Transfer>::drive_of(
    double dt, const std::array<double, Dim>& body, const std::array<double, Dim>& inertial) const {
  Drive drive{.dt = dt, .body = body, .inertial = inertial};
  for (int d = 0; d < Dim; ++d) {
    drive.shaken = drive.shaken || inertial[d] != 0.0;
    drive.acceleration[d] = body[d];
  }
  drive.untouched = !drive.shaken && !wall_nodes_.any_frictional() && !(options_.local_damping > 0.0);
  return drive;
}

// Nodes at mirrors need their images' sums, so those are complete before any velocity is made.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::complete_sums() {
  for (int f = 0; f < fields_.count(); ++f) {
    Vec4* sums = sums_.data() + node_of(f, 0);
    Vec4* forces = Split ? force_sums_.data() + node_of(f, 0) : nullptr;
#pragma omp parallel for schedule(dynamic, 4)
    for (std::size_t a = 0; a < grid_.active(); ++a)
      if (fields_.present(f, a))
        gather_sums<Dim, Shape, Split>(fields_.around(f, a), tiles_of(f), beside_of(f), sums + a * block_nodes,
                                       Split ? forces + a * block_nodes : nullptr);
    mirrors_.fold(sums);
    if constexpr (Split) mirrors_.fold(forces);
    if (extension_.active()) {
      extension_.choose(sums);
      extension_.fold_momentum(sums);
      if constexpr (Split) extension_.fold_force(sums, forces);
    }
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
GridSums<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::rest_block(std::size_t a) {
  if (fields_.shared(a)) clear_grips(a);
  for (int f = 0; f < fields_.count(); ++f) {
    if (!fields_.present(f, a)) continue;
    std::fill_n(velocity_.data() + node_of(f, a), block_nodes, Vec4{});
    if (options_.local_damping > 0.0)
      std::fill_n(damped_.data() + node_of(f, a), block_nodes, std::array<double, Dim>{});
    if (ground_.of_block(a)) std::fill_n(grip_.data() + node_of(f, a), block_nodes, NodeGrip{});
  }
  if (filling_.active() && !filling_.is_known(a)) {
    filling_.begin(a, true);
    Vec4 sum[block_nodes], force[block_nodes];
    for (int f = 0; f < fields_.count(); ++f)
      if (fields_.present(f, a)) {
        if (!needs_all_sums())
          gather_sums<Dim, Shape, Split>(fields_.around(f, a), tiles_of(f), beside_of(f), sum, Split ? force : nullptr);
        filling_.weigh(a, needs_all_sums() ? sums_.data() + node_of(f, a) : sum);
      }
  }
  return {};
}

// All that happens to the nodes of one block.
template <int Dim, class Shape, bool Split, TransferName Transfer>
GridSums<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::move_block(std::size_t a, const Drive& drive) {
  Vec4 own_sum[most_fields][block_nodes], own_force[Split ? most_fields : 1][block_nodes];
  NodeSums node[most_fields];
  const bool touched = ground_.of_block(a) || !drive.untouched;
  GridSums<Dim> sums;
  if (filling_.active()) filling_.begin(a, false);
  for (int f = 0; f < fields_.count(); ++f) {
    if (!fields_.present(f, a)) continue;
    if (needs_all_sums()) {
      node[f] = {sums_.data() + node_of(f, a), Split ? force_sums_.data() + node_of(f, a) : nullptr};
    } else {
      node[f] = {own_sum[f], own_force[Split ? f : 0]};
      gather_sums<Dim, Shape, Split>(fields_.around(f, a), tiles_of(f), beside_of(f), own_sum[f],
                                     own_force[Split ? f : 0]);
    }
    if (filling_.active()) filling_.weigh(a, node[f].sum);
    if (!touched)
      sums += move_free_nodes<Dim, Split>(drive.dt, drive.acceleration, mass_cutoff_, node[f].sum, node[f].force,
                                          velocity_.data() + node_of(f, a),
                                          separate_change ? change_.data() + node_of(f, a) : nullptr);
    else
      drive_nodes(f, a, drive, node[f], sums);
  }
  NodeGaps gap[most_fields];
  NodeFields settled{};
  if (ground_.of_block(a)) gather_gaps(a, gap);
  if (fields_.shared(a)) {
    clear_grips(a);
    part_fields(a, drive.dt, node, gap, settled, sums);
  }
  if (touched)
    for (int f = 0; f < fields_.count(); ++f)
      if (fields_.present(f, a)) touch_boundaries(f, a, drive, node[f], gap[f], settled, sums);
  if constexpr (Split)
    if (touched || fields_.shared(a)) {
      sums.impact = -sums.friction - sums.contact;
      for (int f = 0; f < fields_.count(); ++f)
        if (fields_.present(f, a)) book_impacts(f, a, drive, node[f], sums);
    }
  return sums;
}

// What contact took from the nodes of field f, friction and all: an impulse J costs - J . (v + v') / 2 with the
// velocities at the step's ends.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::book_impacts(int f, std::size_t a, const Drive& drive,
                                                               const NodeSums& node, GridSums<Dim>& sums) {
  for (int n = 0; n < block_nodes; ++n) {
    const double m = node.sum[n][0];
    if (m <= mass_cutoff_) continue;
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    for (int d = 0; d < Dim; ++d) {
      const double driven =
          node.sum[n][1 + d] / m + drive.dt * node.force[n][1 + d] / m + drive.dt * (drive.body[d] + drive.inertial[d]);
      double impulse = m * (velocity_[k][d] - driven);
      if (options_.local_damping > 0.0) impulse += damped_[k][d];
      sums.impact -= impulse * (velocity_[k][d] - 0.5 * change_of(k, d));
    }
  }
}

// v = p / m + dt (f / m + b), and local damping.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::drive_nodes(int f, std::size_t a, const Drive& drive,
                                                              const NodeSums& node, GridSums<Dim>& sums) {
  for (int n = 0; n < block_nodes; ++n) {
    const double m = node.sum[n][0];
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    if constexpr (separate_change) change_[k] = Vec4{};
    velocity_[k] = Vec4{};
    if (options_.local_damping > 0.0) damped_[k] = {};
    if (m <= mass_cutoff_) continue;
    std::array<double, Dim> v, before{};
    for (int d = 0; d < Dim; ++d) {
      v[d] = node.sum[n][1 + d] / m;
      if constexpr (Split) {
        before[d] = v[d];
        v[d] += drive.dt * node.force[n][1 + d] / m;
      }
      v[d] += drive.dt * (drive.body[d] + drive.inertial[d]);
    }
    if constexpr (Split) {
      sums.kinetic_before += 0.5 * m * square<Dim>(before);
      if (options_.local_damping > 0.0) damped_[k] = apply_local_damping<Dim>(options_.local_damping, m, before, v);
    }
    set_velocity(k, v, before);
    if constexpr (Split) sums.kinetic_after += 0.5 * m * square<Dim>(v);
  }
}

// How far the fields of block a are from the ground; no node of theirs touches it yet.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::gather_gaps(std::size_t a, NodeGaps* gap) {
  for (int f = 0; f < fields_.count(); ++f) {
    if (!fields_.present(f, a)) continue;
    gather_tiles<Dim, Shape>(fields_.around(f, a), gap_tiles_.data() + fields_.tile(f, 0) * tile_nodes,
                             gap[f].emplace().data());
    std::fill_n(grip_.data() + node_of(f, a), block_nodes, NodeGrip{});
  }
}

// The ground stops the approach of the nodes near it unless that is settled, frictional walls hold theirs; what shaking
// gives is booked.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::touch_boundaries(int f, std::size_t a, const Drive& drive,
                                                                   const NodeSums& node, const NodeGaps& gap,
                                                                   const NodeFields& settled, GridSums<Dim>& sums) {
  const double dt = drive.dt;
  const NodeContact* contact = ground_.of_block(a);
  for (int n = 0; n < block_nodes; ++n) {
    const double m = node.sum[n][0];
    const std::size_t k = node_of(f, a) + static_cast<std::size_t>(n);
    const bool held = in_body(a, n);
    if (m <= mass_cutoff_ || held) {
      if (contact) smoothed_grip_[k] = 0.0;
      if (held && drive.shaken)
        for (int d = 0; d < Dim; ++d) sums.external += dt * m * drive.inertial[d] * velocity_[k][d];
      continue;
    }
    std::array<double, Dim> v = velocity_at(k), before{};
    const std::array<double, Dim> pushed = v;
    if (contact && contact[n].beside && options_.soil_limits_friction) {
      grip_[k] = grip_beside(contact[n], (*gap)[n], m, carried_by_soil((*gap)[n], ground_.surfaces(a)[n], dt));
      if (const double drag = drag_beside(contact[n], (*gap)[n], ground_.surfaces(a)[n], dt); drag > 0.0) {
        NodeGrip stuck;
        stuck.mass = m;
        stuck.normal = contact[n].point[0].normal;
        sums.friction += apply_friction<Dim>(stuck, drag, v);
      }
    }
    if (contact && contact[n].count > 0) {
      NodeGrip& grip = grip_[k];
      if (!(settled[n] >> f & 1U)) grip = stop_approach<Dim>(contact[n], m, std::max(0.0, (*gap)[n].value) / dt, v);
      const double share = smoothing_share(dt * h1_ * fastest_wave_, dt * h1_ * sliding_speed<Dim>(contact[n], v));
      smooth_grip(contact[n], m, dt, share, smoothed_grip_[k], grip);
      grip.carried = grip.friction;
      if (options_.soil_limits_friction) grip.carried = carried_by_soil((*gap)[n], ground_.surfaces(a)[n], dt);
    }
    if (wall_nodes_.any) apply_walls<Dim>(wall_nodes_, grid_.node_index(a, n), m, v, sums);
    for (int d = 0; d < Dim; ++d) sums.impulse[d] += m * (v[d] - pushed[d]);
    if (drive.shaken)
      for (int d = 0; d < Dim; ++d) sums.external += dt * m * drive.inertial[d] * v[d];
    if constexpr (Split) {
      for (int d = 0; d < Dim; ++d) before[d] = pushed[d] - change_of(k, d);
      sums.kinetic_after += 0.5 * m * (square<Dim>(v) - square<Dim>(pushed));
    }
    if (v != pushed) set_velocity(k, v, before);
  }
}

// Mirrors, and the velocity beyond the surface of elastic bodies.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::continue_velocities() {
  for (int f = 0; f < fields_.count(); ++f) {
    Vec4* velocity = velocity_.data() + node_of(f, 0);
    Vec4* change = separate_change ? change_.data() + node_of(f, 0) : nullptr;
    const auto reflect = [&] {
      mirrors_.reflect(velocity);
      if constexpr (separate_change) mirrors_.reflect(change);
    };
    if (mirrors_.any()) reflect();
    if (!extension_.active()) continue;
    extension_.extend(velocity);
    if constexpr (separate_change) extension_.extend(change);
    if (mirrors_.any()) reflect();
  }
}

// In the order of the blocks, so that the sums do not depend on the number of threads.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::add_up() {
  nodes_gain_ = 0.0;
  for (const auto& s : grid_sums_) {
    work_.friction += s.friction;
    work_.contact += s.contact;
    work_.damping += s.damping;
    work_.external += s.external;
    if constexpr (Split) work_.impact += s.impact;
    nodes_gain_ += s.kinetic_after - s.kinetic_before;
    for (int d = 0; d < Dim; ++d) impulse_[d] += s.impulse[d];
  }
}

}  // namespace tailrun::mpm

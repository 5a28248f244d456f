// Memory and neighbours of the blocks after a sort of the particles, and what nodes keep over it; included by
// explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::sort() {
  const auto since = Clock::now();
  std::vector<std::uint8_t> keep;
  if (leaving_) {
    keep.assign(P_.count(), 1);
    for (std::size_t p = 0; p < P_.count(); ++p)
      for (int d = 0; d < Dim; ++d)
        if (P_.position[d][p] < walls_.low[d] || P_.position[d][p] > walls_.high[d]) keep[p] = 0;
    for (std::size_t p = 0; p < P_.count(); ++p) {
      if (keep[p]) continue;
      if (walls_.leaving == LeavingParticles::error) fail(p, p + 1, "left the domain (see domain/leaving_particles)");
      removed_.push_back(P_.identity[p]);
      work_.removed += 0.5 * P_.mass[p] * speed_squared(p);
      kinetic_ -= 0.5 * P_.mass[p] * speed_squared(p);
    }
  }
  if (sleep_.active()) sleep_.before_sort(grid_);
  // What new shares change is no work, nor what particles take along that leave.
  if (water_.any() && sorts_ > 0) water_potential_ -= water_potential(water_levels_);
  grid_.sort(P_, keep, options_.fields);
  if (options_.fields.by_side && find_sides<Dim, Shape>(
                                     grid_, options_.fields, [this](std::size_t b) { return corner(b); }, P_))
    grid_.sort(P_, {}, options_.fields);
  if (grid_.occupied() == 0) throw ComputationError("no particle is left in the domain");
  lay_out();
  if (sleep_.active())
    sleep_.after_sort(grid_, [this](std::size_t b) {
      for (std::size_t p = grid_.first_particle(b); p < grid_.last_particle(b); ++p)
        if (speed_squared(p) > 0.0) return true;
      return false;
    });
  if (water_.any()) {
    water_.update(grid_, P_, time_, [this](std::size_t a, int n) { return is_solid(a, n); });
    if (sorts_ == 0) water_levels_ = water_.levels();
    water_potential_ += water_potential(water_levels_);
  }
  ++sorts_;
  drift_ = 0.0;
  leaving_ = false;

  // Wave speeds follow the lowest density of each material.
  std::vector<double> density(constants_.size(), 1e300);
  for (std::size_t p = 0; p < P_.count(); ++p)
    density[P_.material[p]] = std::min(density[P_.material[p]], P_.mass[p] / P_.volume[p]);
  wave_speed_.assign(constants_.size(), 0.0);
  viscous_limit_ = 1e30;
  for (std::size_t m = 0; m < constants_.size(); ++m) {
    if (density[m] > 1e299) continue;
    wave_speed_[m] = std::sqrt(constants_[m].wave_modulus() / density[m]);
    if (constants_[m].explicit_viscosity > 0.0)
      viscous_limit_ = std::min(
          viscous_limit_, options_.courant * h_ * h_ * density[m] / (2.0 * Dim * constants_[m].explicit_viscosity));
  }
  add_time(seconds_.sort, since);
}

// A node feels particles that are nearer than half of its function's width.
template <int Dim, class Shape, bool Split, TransferName Transfer>
typename FieldLayout<Dim>::Reach ExplicitSolver<Dim, Shape, Split, Transfer>::reach_of(std::size_t b, std::size_t begin,
                                                                                       std::size_t end) const {
  constexpr double far = 0.5 * Shape::support + largest_drift;  // cells
  typename FieldLayout<Dim>::Reach reach;
  for (int d = 0; d < Dim; ++d) {
    const auto [low, high] = std::minmax_element(P_.position[d].begin() + static_cast<std::ptrdiff_t>(begin),
                                                 P_.position[d].begin() + static_cast<std::ptrdiff_t>(end));
    const double first = grid_.origin()[d] + grid_.occupied_index(b)[d] * Block<Dim>::cells * h_;
    reach.low[d] = static_cast<int>(std::floor((*low - first) * h1_ - far));
    reach.high[d] = static_cast<int>(std::ceil((*high - first) * h1_ + far));
  }
  return reach;
}

// Memory and neighbours of the grid's blocks.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::lay_out() {
  const GripMemory<Dim> memory = grip_memory();
  ground_.update(grid_);
  mirrors_.update(grid_, wall_nodes_, Shape::support == 4 ? 2 : 1);
  fields_.update(grid_, options_.fields.count,
                 [this](std::size_t b, std::size_t begin, std::size_t end) { return reach_of(b, begin, end); });
  const auto several = static_cast<std::size_t>(fields_.count());
  tiles_.resize(several * grid_.occupied() * tile_nodes);
  if (Split) beside_.resize(tiles_.size());
  // Where a field is not, nothing is computed, and what looks there finds it at rest and without mass.
  velocity_.assign(several * grid_.active() * block_nodes, Vec4{});
  change_.clear();
  sums_.clear();
  force_sums_.clear();
  grip_.clear();
  if (fields_.several()) {
    interface_tiles_.resize(tiles_.size());
    // Who meets where is found out anew in the next step.
    meeting_.assign(grid_.active() * block_nodes, not_met);
    for (const std::size_t a : fields_.shared_blocks())
      std::fill_n(meeting_.begin() + static_cast<std::ptrdiff_t>(a * block_nodes), block_nodes, met);
    interfaces_.assign(several * fields_.shared_blocks().size() * block_nodes, InterfaceNode{});
    const auto pairs = static_cast<std::size_t>(pairs_of(fields_.count()));
    field_grip_.assign(pairs * fields_.shared_blocks().size() * block_nodes, FieldGrip<Dim>{});
    gripping_.assign(pairs * fields_.shared_blocks().size(), 0);
    field_spread_.resize(field_grip_.size());
    contact_surface_.resize(field_grip_.size());
    known_meeting_.assign(fields_.shared_blocks().size() * block_nodes, NodeMeeting{});
  }
  if (separate_change) change_.resize(velocity_.size());
  if (options_.local_damping > 0.0) damped_.assign(velocity_.size(), {});
  if (needs_all_sums()) {
    sums_.resize(velocity_.size());
    if (Split) force_sums_.resize(velocity_.size());
  }
  if (Transfer == TransferName::fmpm) {
    term_.resize(velocity_.size());
    products_.resize(velocity_.size());
    held_nodes_.resize(several * grid_.active());
  }
  if (averaging_) {
    averaged_tiles_.resize(grid_.occupied() * tile_nodes);
    averaged_.resize(grid_.active() * block_nodes);
    if (filling_.active()) filling_.lay_out(grid_, [this](std::size_t a, int n) { return share_above(a, n); });
  }
  if (ground_.any()) {
    gap_tiles_.resize(tiles_.size());
    grip_.resize(velocity_.size());
    spread_.resize(velocity_.size());
  }
  remember_grip(memory);
  if (extension_.active()) extension_.update(grid_, surface_roles());
  grid_sums_.resize(grid_.active());
  motion_.resize(grid_.occupied());
  stress_work_.resize(grid_.occupied());
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
GripMemory<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::grip_memory() const {
  GripMemory<Dim> memory;
  const auto keep = [&memory](const std::vector<double>& smoothed, const auto& blocks, int first_number) {
    for (std::size_t b = 0; b < smoothed.size() / block_nodes; ++b) {
      const auto first = smoothed.begin() + static_cast<std::ptrdiff_t>(b * block_nodes);
      if (std::none_of(first, first + block_nodes, [](double s) { return s > 0.0; })) continue;
      memory.blocks.push_back(blocks[b % blocks.size()]);
      memory.fields.push_back(first_number + static_cast<int>(b / blocks.size()));
      memory.smoothed.insert(memory.smoothed.end(), first, first + block_nodes);
    }
  };
  keep(smoothed_grip_, grip_blocks_, 0);
  keep(smoothed_push_, push_blocks_, most_fields);
  return memory;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::remember_grip(const GripMemory<Dim>& memory) {
  std::map<std::pair<int, std::array<int, Dim>>, std::size_t> known;
  for (std::size_t b = 0; b < memory.blocks.size(); ++b) known[{memory.fields[b], memory.blocks[b]}] = b;
  const auto recall = [&](int number, const std::array<int, Dim>& block, double* smoothed) {
    const auto it = known.find({number, block});
    if (it == known.end()) return;
    const auto first = memory.smoothed.begin() + static_cast<std::ptrdiff_t>(it->second * block_nodes);
    std::copy(first, first + block_nodes, smoothed);
  };
  if (ground_.any()) {
    smoothed_grip_.assign(velocity_.size(), 0.0);
    grip_blocks_.resize(grid_.active());
    for (std::size_t a = 0; a < grid_.active(); ++a) {
      grip_blocks_[a] = grid_.active_index(a);
      for (int f = 0; f < fields_.count(); ++f) recall(f, grip_blocks_[a], smoothed_grip_.data() + node_of(f, a));
    }
  }
  if (fields_.several() && options_.contact.friction >= 0.0) {
    smoothed_push_.assign(field_grip_.size(), 0.0);
    push_blocks_.clear();
    for (const std::size_t a : fields_.shared_blocks()) {
      push_blocks_.push_back(grid_.active_index(a));
      for (int pair = 0; pair < pairs_of(fields_.count()); ++pair)
        recall(most_fields + pair, push_blocks_.back(), smoothed_push_.data() + grip_of(pair, a));
    }
  }
}

// Whether node n of active block a is in a body or may come to be before the next sort.
template <int Dim, class Shape, bool Split, TransferName Transfer>
bool ExplicitSolver<Dim, Shape, Split, Transfer>::in_reach_of_body(std::size_t a, int n) const {
  const std::array<int, Dim> node = grid_.node_index(a, n);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    bool near = true;
    for (int d = 0; d < Dim; ++d) {
      const double x = grid_.origin()[d] + node[d] * h_ - bodies_[b].displacement[d];
      near = near && x > walls_.bodies[b].low[d] - h_ && x < walls_.bodies[b].high[d] + h_;
    }
    if (near) return true;
  }
  return false;
}

// Whether node n of active block a lies in the ground, beyond a wall or in a body.
template <int Dim, class Shape, bool Split, TransferName Transfer>
bool ExplicitSolver<Dim, Shape, Split, Transfer>::is_solid(std::size_t a, int n) const {
  if (ground_.of_block(a) && ground_.distances(a)[n] < 0.0) return true;
  const std::array<int, Dim> node = grid_.node_index(a, n);
  for (int d = 0; d < Dim; ++d)
    for (int s = 0; s < 2; ++s) {
      const auto& side = wall_nodes_.side[d][s];
      if (side.kind != WallKind::open && (s == 0 ? node[d] < side.node : node[d] > side.node)) return true;
    }
  return in_reach_of_body(a, n);
}

// Share of node n's shape function above the ground, as if that were plane there and the function a Gaussian of the
// same width; none beyond a wall or in a body.
template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::share_above(std::size_t a, int n) const {
  const double variance = Shape::support / 12.0;  // cells squared, of a B-spline
  const double above = ground_.of_block(a) ? ground_.distances(a)[n] * h1_ : 10.0;
  if (above > 0.0 && is_solid(a, n)) return 0.0;
  return 0.5 * (1.0 + std::erf(above / std::sqrt(2.0 * variance)));
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
std::vector<SurfaceRole> ExplicitSolver<Dim, Shape, Split, Transfer>::surface_roles() const {
  std::vector<SurfaceRole> role(grid_.active() * block_nodes, SurfaceRole::any);
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    const NodeContact* contact = ground_.of_block(a);
    for (int n = 0; n < block_nodes; ++n) {
      SurfaceRole& r = role[a * block_nodes + static_cast<std::size_t>(n)];
      if (contact && contact[n].count > 0) r = SurfaceRole::held;
      if (in_reach_of_body(a, n)) r = SurfaceRole::held;
      const std::array<int, Dim> node = grid_.node_index(a, n);
      for (int d = 0; d < Dim; ++d)
        for (int s = 0; s < 2; ++s) {
          const auto& side = wall_nodes_.side[d][s];
          const int depth = s == 0 ? node[d] - side.node : side.node - node[d];
          if (side.kind == WallKind::open || depth > 0) continue;
          if (depth < 0)
            r = SurfaceRole::none;
          else if (side.kind != WallKind::slip)
            r = std::max(r, SurfaceRole::held);
        }
    }
  }
  return role;
}

}  // namespace tailrun::mpm

// The explicit step, symplectic Euler on the grid (Sulsky, Chen & Schreyer 1994), in the order
//   nodes:      v = p / m, body forces, damping, walls, ground; with FMPM the filter of mass_filter.hpp
//   G2P:        velocities, affine velocities, gradients; particles move, and add their volumetric increments to the
//               nodes' averages (the cure of locking)
//   sort:       only when some particle may have left its block's margin
//   average:    the nodes' averages
//   stress:     constitutive update, volumes, and P2G of the next step, with its time step
// Particles pass through the core twice a step: in G2P, and in stress and P2G, each block by block.
// Every loop runs over blocks in parallel and writes what is its block's own; sums over blocks are taken in block order
// afterwards, so results do not depend on the number of threads.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <type_traits>

#include "common/error.hpp"
#include "mpm_stage/boundary/contact_gap.hpp"
#include "mpm_stage/boundary/contact_turns.hpp"
#include "mpm_stage/boundary/ground_friction.hpp"
#include "mpm_stage/boundary/half_spaces.hpp"
#include "mpm_stage/boundary/held_directions.hpp"
#include "mpm_stage/boundary/mirror_walls.hpp"
#include "mpm_stage/boundary/ponded_water.hpp"
#include "mpm_stage/boundary/surface_extension.hpp"
#include "mpm_stage/grid/field_layout.hpp"
#include "mpm_stage/grid/field_sides.hpp"
#include "mpm_stage/grid/tiles.hpp"
#include "mpm_stage/material/stress_update.hpp"
#include "mpm_stage/step/grid_update.hpp"
#include "mpm_stage/step/lone_particle.hpp"
#include "mpm_stage/step/sleeping_blocks.hpp"
#include "mpm_stage/step/solver.hpp"
#include "mpm_stage/step/surface_age.hpp"
#include "mpm_stage/transfer/grid_to_particles.hpp"
#include "mpm_stage/transfer/interface_sums.hpp"
#include "mpm_stage/transfer/mass_matrix.hpp"
#include "mpm_stage/transfer/particles_to_grid.hpp"
#include "mpm_stage/transfer/patch_filling.hpp"
#include "mpm_stage/transfer/sparse_patches.hpp"
#include "mpm_stage/transfer/volumetric_projection.hpp"

namespace tailrun::mpm {

// Split keeps momentum and forces apart (FLIP and damping need both).
template <int Dim, class Shape, bool Split, TransferName Transfer>
class ExplicitSolver final : public Solver<Dim> {
 public:
  ExplicitSolver(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                 Particles<Dim> particles, const std::vector<Material>& materials, const Terrain& terrain,
                 const Walls<Dim>& walls);

  void start(double limit) override;
  void resume(Particles<Dim> particles, const SolverState<Dim>& s) override;
  SolverState<Dim> state() const override;
  bool resumable() const override { return !fields_.several() || surface_age_.due(); }

  StepReport step(const std::array<double, Dim>& body, const std::array<double, Dim>& inertial, double limit) override {
    StepReport report;
    const double dt = next_dt_;
    report.dt = dt;
    if (sleep_.active() && std::any_of(inertial.begin(), inertial.end(), [](double a) { return a != 0.0; }))
      sleep_.wake_all();
    if (sleep_.active() && water_.moves(time_ + dt)) sleep_.wake_all();
    update_grid(dt, body, inertial);
    if constexpr (Transfer == TransferName::fmpm) filter_velocity(dt);
    const double drifted = drift_;
    gather(dt, report);
    const double drift = drift_ - drifted;
    if (drift_ > largest_drift || leaving_ || water_.outdated(h_)) {
      sort();
      report.sorted = true;
    }
    next_dt_ = longest_step(limit);
    report.next_dt = next_dt_;
    if (fields_.several()) surface_age_.pass(drift, report.sorted);
    if (averaging_) average(report.sorted);
    if (water_.any()) water_.set_time(time_ + dt);
    update_stresses(dt);
    time_ += dt;
    return report;
  }

  double next_dt() const override { return next_dt_; }
  Particles<Dim>& particles() override { return P_; }
  const BlockGrid<Dim>& grid() const override { return grid_; }
  const WorkDone& work() const override { return work_; }
  const PhaseSeconds& seconds() const override { return seconds_; }
  std::array<double, Dim> boundary_impulse() const override { return impulse_; }
  const std::vector<BodyState<Dim>>& bodies() const override { return bodies_; }
  const std::vector<PondState>& ponds() const override { return water_.states(); }
  std::vector<std::int32_t> removed() const override { return removed_; }
  std::vector<std::int32_t> held() const override {
    std::vector<std::int32_t> identities;
    for (std::size_t k = 0; k < held_.size(); ++k)
      if (held_[k]) identities.push_back(static_cast<std::int32_t>(k));
    return identities;
  }
  long sorts() const override { return sorts_; }

  double elastic_energy() const override;
  std::string most_energetic() const override;
  double unbalanced_force_ratio(const std::array<double, Dim>& body) const override;

  std::size_t grid_bytes() const override;

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int tile_nodes = Tile<Dim, Shape>::nodes;
  static constexpr int block_nodes = Block<Dim>::nodes;
  static constexpr double grazing = 0.1;         // cells, by which a particle may come to lie beyond a wall
  static constexpr double largest_drift = 0.99;  // cells, of a particle since the last sort: the tiles' margin
  // Particles that pass through the stress update together: what is known of them fits into the first-level cache.
  static constexpr std::size_t few_particles = 128;
  // In 2-D a node's four lanes have room for the velocity's change over the step beside the velocity.
  static constexpr bool separate_change = Split && Dim == 3;
  static constexpr int change_at = separate_change ? 0 : 2;  // lane of the change's first component

  struct BlockMotion {
    double far = 0.0, wave = 0.0, fast = 0.0, kinetic = 0.0;
    double stopped = 0.0;  // J, taken from particles held at a side of the domain
    bool outside = false, asleep = false;
  };

  // What moves the nodes in a step.
  struct Drive {
    double dt;                               // s
    std::array<double, Dim> body, inertial;  // m/s2
    Vec4 acceleration = {};                  // `body` in the first Dim lanes
    bool shaken = false;
    bool untouched = true;  // but for ground and mirrors: no shaking, frictional walls or damping
  };
  // A field's sums at the nodes of a block, as gather_sums makes them.
  struct NodeSums {
    const Vec4 *sum = nullptr, *force = nullptr;
  };
  // How far material of a field is from the ground, at the nodes of a block near it.
  using NodeGaps = std::optional<std::array<Gap<Dim>, block_nodes>>;
  // Fields, as bits, at the nodes of a block.
  using NodeFields = std::array<std::uint8_t, block_nodes>;
  // The bodies that meet at a node, and which one each field belongs to (-1: the field is not there).
  struct NodeBodies {
    std::array<BodyAtNode<Dim>, most_fields> body;
    std::array<int, most_fields> of_field{-1, -1, -1, -1};
    std::array<int, most_fields> field{};  // of each body, the first one
    int count = 0;
  };

  static void add_time(double& phase, Clock::time_point since) {
    phase += std::chrono::duration<double>(Clock::now() - since).count();
  }

  std::array<double, Dim> corner(std::size_t b) const {
    std::array<double, Dim> c;
    for (int d = 0; d < Dim; ++d)
      c[d] = grid_.origin()[d] + (grid_.occupied_index(b)[d] * Block<Dim>::cells + Tile<Dim, Shape>::low) * h_;
    return c;
  }

  double speed_squared(std::size_t p) const {
    double s = 0.0;
    for (int d = 0; d < Dim; ++d) s += P_.velocity[d][p] * P_.velocity[d][p];
    return s;
  }

  // Whether the nodes' sums have to be complete before any velocity is made.
  bool needs_all_sums() const {
    return Transfer == TransferName::fmpm || mirrors_.any() || extension_.active() || !bodies_.empty();
  }
  // s. The filter of FMPM(k) raises the rate of change of a node's velocity up to k times (mass_filter.hpp).
  double longest_step(double limit) const {
    const double raised = Transfer == TransferName::fmpm ? options_.fmpm_order : 1.0;
    return std::min({options_.courant * h_ / fastest_wave_ / std::sqrt(raised), options_.maximum_step,
                     viscous_limit_ / raised, limit});
  }
  double flip_share(double dt, const MaterialConstants& k) const {
    if (Transfer != TransferName::aflip) return options_.flip_share;
    const double damping = k.flows ? options_.flow_transfer_damping : options_.transfer_damping;
    return 1.0 - std::min(1.0, damping * dt * h1_ * fastest_wave_);
  }
  // Field f's node 0 of active block a in arrays by nodes, and its tiles.
  std::size_t node_of(int f, std::size_t a) const { return fields_.number(f, a) * block_nodes; }
  // Of a pair of fields (pair_of) in active block a, which several fields reach: node 0 in field_grip_.
  std::size_t grip_of(int pair, std::size_t a) const {
    return (static_cast<std::size_t>(pair) * fields_.shared_blocks().size() +
            static_cast<std::size_t>(fields_.shared_number(a))) *
           block_nodes;
  }
  const Vec4* tiles_of(int f) const { return tiles_.data() + fields_.tile(f, 0) * tile_nodes; }
  const SplitNode<Dim>* beside_of(int f) const {
    return Split ? beside_.data() + fields_.tile(f, 0) * tile_nodes : nullptr;
  }
  std::array<double, Dim> velocity_at(std::size_t node) const {
    std::array<double, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = velocity_[node][d];
    return v;
  }
  // `before` (m/s) is the velocity at the step's start, which the transfer asks for where momentum and forces are
  // apart.
  void set_velocity(std::size_t node, const std::array<double, Dim>& v, const std::array<double, Dim>& before) {
    velocity_[node] = node_velocity<Dim>(v.data());
    if constexpr (Split) {
      Vec4& change = separate_change ? change_[node] : velocity_[node];
      for (int d = 0; d < Dim; ++d) change[change_at + d] = v[d] - before[d];
    }
  }
  void add_change(std::size_t node, const std::array<double, Dim>& dv) {
    Vec4& change = separate_change ? change_[node] : velocity_[node];
    for (int d = 0; d < Dim; ++d) change[change_at + d] += dv[d];
  }
  // m/s, of the node's velocity over this step, with the changes added so far.
  double change_of(std::size_t node, int d) const {
    return separate_change ? change_[node][d] : velocity_[node][2 + d];
  }
  // Of field f in active block a, which several fields reach: node 0 in interfaces_.
  std::size_t interface_of(int f, std::size_t a) const {
    return (static_cast<std::size_t>(f) * fields_.shared_blocks().size() +
            static_cast<std::size_t>(fields_.shared_number(a))) *
           block_nodes;
  }
  // Of active block a, which several fields reach: node 0 in known_meeting_.
  std::size_t known_of(std::size_t a) const { return static_cast<std::size_t>(fields_.shared_number(a)) * block_nodes; }
  void limit_volumes();
  void sort();
  void lay_out();
  typename FieldLayout<Dim>::Reach reach_of(std::size_t b, std::size_t begin, std::size_t end) const;
  std::vector<SurfaceRole> surface_roles() const;
  GripMemory<Dim> grip_memory() const;
  void remember_grip(const GripMemory<Dim>& memory);
  bool in_reach_of_body(std::size_t a, int n) const;
  bool is_solid(std::size_t a, int n) const;
  double share_above(std::size_t a, int n) const;
  bool still(std::size_t a) const;
  template <class Load>
  bool sleeps_on(std::size_t b, const Vec4* tile, Load load, double dt);
  double wave_speed_in(std::size_t b) const;
  void lay_to_rest(std::size_t b, BlockMotion& motion);
  void mind_sides(std::size_t b, BlockMotion& motion);
  void update_grid(double dt, const std::array<double, Dim>& body, const std::array<double, Dim>& inertial);
  Drive drive_of(double dt, const std::array<double, Dim>& body, const std::array<double, Dim>& inertial) const;
  void complete_sums();
  GridSums<Dim> rest_block(std::size_t a);
  GridSums<Dim> move_block(std::size_t a, const Drive& drive);
  void drive_nodes(int f, std::size_t a, const Drive& drive, const NodeSums& node, GridSums<Dim>& sums);
  void gather_gaps(std::size_t a, NodeGaps* gap);
  void touch_boundaries(int f, std::size_t a, const Drive& drive, const NodeSums& node, const NodeGaps& gap,
                        const NodeFields& settled, GridSums<Dim>& sums);
  unsigned fields_at(std::size_t a, int n, const NodeSums* node) const;
  NodeMeeting meeting_at(std::size_t a, int n, unsigned there);
  NodeMeeting find_meeting(std::size_t a, int n, unsigned there);
  NodeBodies bodies_at(std::size_t a, int n, const NodeMeeting& meeting, const NodeSums* node) const;
  void set_motion(std::size_t node, BodyAtNode<Dim>& body) const;
  void join_sides(std::size_t a, int n, const NodeSums* node, GridSums<Dim>& sums);
  void gather_interfaces();
  void smooth_surfaces();
  SurfaceAround<Dim> surface_around(int f, std::size_t a, int n) const;
  ContactPairs<Dim> contact_pairs(std::size_t a, int n, NodeBodies& bodies, double dt) const;
  void clear_grips(std::size_t a);
  void keep_grips(std::size_t a, int n, const NodeBodies& bodies, const ContactPairs<Dim>& pairs);
  void rub_fields(double dt);
  void rub_fields_of(std::size_t s);
  void brake_body(unsigned fields, std::size_t a, int n, double mass, const std::array<double, Dim>& dv,
                  GridSums<Dim>& sums);
  void part_fields(std::size_t a, double dt, const NodeSums* node, const NodeGaps* gap, NodeFields& settled,
                   GridSums<Dim>& sums);
  void take_over(std::size_t a, int n, const NodeSums* node, const NodeBodies& bodies, GridSums<Dim>& sums);
  void settle_on_ground(std::size_t a, int n, double dt, const NodeSums* node, const NodeGaps* gap,
                        const NodeContact& contact, NodeBodies& bodies, ContactPairs<Dim>& pairs, GridSums<Dim>& sums);
  void book_impacts(int f, std::size_t a, const Drive& drive, const NodeSums& node, GridSums<Dim>& sums);
  void continue_velocities();
  void add_up();
  void scatter_interfaces(std::size_t b);
  void filter_velocity(double dt);
  void take_increment(int f, std::size_t a);
  void share_increments();
  void share_increments_at(std::size_t a, int n, unsigned there);
  void find_held(int f, std::size_t a, double dt);
  void keep_contact(int f, std::size_t a);
  void gather(double dt, StepReport& report);
  void scatter_average(std::size_t b);
  void average(bool sorted);
  void update_stresses(double dt);
  StressWork update_stresses_of(std::size_t b, double dt);
  void particles_to_grid();
  void scatter_block(std::size_t b);
  void scatter_ground_gaps(std::size_t b);
  double water_potential(const std::vector<double>& levels) const;
  void book_water();
  void rub_ground(const Drive& drive);
  void rub_block(int f, std::size_t a, const Drive& drive);
  void sum_kinetic_after();
  void book_damping();
  void find_nodes_in_bodies(double dt);
  bool in_body(std::size_t a, int n) const;
  void push_nodes(const Drive& drive);
  void push_node(std::size_t k, std::size_t b, const Drive& drive);
  std::string description(std::size_t p) const;
  [[noreturn]] void fail(std::size_t begin, std::size_t end, const std::string& what) const;

  SolverOptions options_;
  double h_, h1_;
  BlockGrid<Dim> grid_;
  FieldLayout<Dim> fields_;
  Particles<Dim> P_;
  std::vector<Material> materials_;
  std::vector<MaterialConstants> constants_;
  Walls<Dim> walls_;
  std::vector<BodyState<Dim>> bodies_;
  std::vector<std::array<double, Dim>> body_velocity_;  // m/s, in this step
  static constexpr std::uint16_t no_body = 0xffff;
  std::vector<std::uint16_t> body_of_node_;  // of the nodes of active blocks, in this step; only with bodies
  WallNodes<Dim> wall_nodes_;
  ContactNodes<Dim> ground_;
  MirrorWalls<Dim> mirrors_;
  SurfaceExtension<Dim> extension_;
  SleepingBlocks<Dim> sleep_;
  PondedWater<Dim> water_;
  PatchFilling<Dim> filling_;
  SparsePatches sparse_;
  double water_potential_ = 0.0;      // J, PondedWater::potential of all particles
  std::vector<double> water_levels_;  // m, for which that is
  bool averaging_ = false, leaving_ = false, starts_with_spin_ = false;
  double kinetic_ = 0.0;     // J, of the particles on the nodes
  double nodes_gain_ = 0.0;  // J, what the nodes' kinetic energy has grown by in this step
  double mass_cutoff_ = 0.0, time_ = 0.0, next_dt_ = 0.0, drift_ = 0.0, fastest_wave_ = 0.0, viscous_limit_ = 1e30;
  std::vector<double> wave_speed_;  // m/s, by material

  // Of each velocity field, one after the other (grid/field_layout.hpp):
  AlignedVector<Vec4> tiles_;                     // per occupied block
  AlignedVector<SplitNode<Dim>> beside_;          // the same, only with Split
  AlignedVector<Vec4> velocity_, change_;         // per active block
  AlignedVector<Vec4> sums_, force_sums_;         // per active block, only with mirrors
  AlignedVector<InterfaceNode> interface_tiles_;  // per occupied block, only with several fields
  AlignedVector<InterfaceNode> interfaces_;       // per block that several fields reach
  AlignedVector<Vec4> surfaces_;                  // the same: size and directions, around the node
  // Of a node: whether fields met there in the last step, and whether their surfaces are known.
  enum Meeting : std::uint8_t { not_met, met, surface_known };
  std::vector<std::uint8_t> meeting_;  // Meeting, per active block; several fields
  SurfaceAge surface_age_;
  HalfSpaces<Shape> half_spaces_;
  std::vector<NodeMeeting> known_meeting_;  // per block that several fields reach
  // Per pair of fields and per block that several fields reach.
  std::vector<ContactSurface<Dim>> contact_surface_;
  std::vector<FieldGrip<Dim>> field_grip_;
  std::vector<std::uint8_t> gripping_;  // whether any of the block's nodes has a grip
  std::vector<Spread> field_spread_;
  std::vector<double> smoothed_push_;            // m/s2, only with Coulomb's friction between fields
  std::vector<std::array<double, Dim>> damped_;  // N s, taken by local damping in this step; per active block
  AlignedVector<PatchSum> averaged_tiles_;
  AlignedVector<PatchFit> averaged_;
  std::vector<Gap<Dim>> gap_tiles_;
  std::vector<NodeGrip> grip_;  // per active block
  // FMPM: the latest term of the velocity and the mass matrix times it, per active block; what contact holds.
  AlignedVector<Vec4> term_, products_;
  AlignedVector<Vec4> contact_velocity_;  // m/s, before the filter; only with several fields
  struct HeldNode {
    std::size_t node;
    HeldDirections<Dim> held;
    std::array<double, Dim> before;        // m/s, velocity before the filter
    const NodeContact* contact = nullptr;  // of the ground, null: none
    double allowed = 0.0;                  // m/s, free approach to it
  };
  std::vector<std::vector<HeldNode>> held_nodes_;                     // per active block
  std::vector<std::pair<std::size_t, std::size_t>> nodes_in_bodies_;  // node, body
  std::vector<Spread> spread_;
  std::vector<double> smoothed_grip_;              // m/s2, per active block
  std::vector<std::array<int, Dim>> grip_blocks_;  // the active blocks that it belongs to
  std::vector<std::array<int, Dim>> push_blocks_;  // the shared blocks of smoothed_push_
  std::vector<GridSums<Dim>> grid_sums_;
  std::vector<BlockMotion> motion_;
  std::vector<StressWork> stress_work_;  // per occupied block

  WorkDone work_;
  PhaseSeconds seconds_;
  std::array<double, Dim> impulse_{};
  std::vector<std::int32_t> removed_;
  std::vector<std::uint8_t> held_;  // by identity; empty unless the domain's sides hold particles
  long sorts_ = 0;
};

}  // namespace tailrun::mpm

#include "mpm_stage/step/body_phase.hpp"
#include "mpm_stage/step/explicit_solver_contact.hpp"
#include "mpm_stage/step/explicit_solver_layout.hpp"
#include "mpm_stage/step/explicit_solver_phases.hpp"
#include "mpm_stage/step/explicit_solver_report.hpp"
#include "mpm_stage/step/explicit_solver_sleep.hpp"
#include "mpm_stage/step/explicit_solver_start.hpp"
#include "mpm_stage/step/field_friction_phase.hpp"
#include "mpm_stage/step/field_phase.hpp"
#include "mpm_stage/step/field_surfaces.hpp"
#include "mpm_stage/step/grid_phase.hpp"
#include "mpm_stage/step/mass_filter.hpp"

// One explicit step of the material point method, as the run loop sees it. The implementation (explicit_solver.hpp) is
// compiled for each combination of dimension, shape function and transfer (solver_list.hpp); the scene picks one at
// set-up.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mpm_stage/boundary/field_contact.hpp"
#include "mpm_stage/boundary/pond.hpp"
#include "mpm_stage/boundary/terrain.hpp"
#include "mpm_stage/boundary/walls.hpp"
#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

enum class ShapeName { linear, quadratic, cubic, gimp };
enum class TransferName { apic, flip, aflip, fmpm };

// Blocks at rest are left out of the step (sleeping_blocks.hpp).
struct SleepOptions {
  double speed = 0.0;  // m/s, of a block's fastest particle; 0: no block sleeps
  double calm = 0.25;  // s, under that speed until it sleeps
  double nap = 1.0;    // s, after which it wakes in any case
};

struct SolverOptions {
  ShapeName shape = ShapeName::quadratic;
  TransferName transfer = TransferName::aflip;
  double flip_share = 0.99;  // 1, of FLIP in a step of the FLIP/PIC blend
  // 1, share of APIC in the AFLIP blend over the time that the fastest wave takes through a cell: what the transfer
  // takes from motion under the grid's resolution then does not depend on the time step.
  double transfer_damping = 0.3;
  // The same for phi = 0 soil and fluids. Where they flow, damping acts as a viscosity beside their own, most of all in
  // a band two cells thick (softened_band); and they need less of it, for what they dissipate themselves takes the
  // noise along. Without any, a flow does not come to rest.
  double flow_transfer_damping = 0.01;
  int fmpm_order = 4;  // terms of the full mass matrix's inverse (mass_filter.hpp); 1 is PIC
  bool volumetric_average = true;
  // 1, share of a patch's crowding that goes with a unit of shear strain (patch_filling.hpp).
  double crowding_relief = 1.0;
  double courant = 0.5;              // 1, dt = courant h / max(c + |v|)
  double maximum_step = 1e30;        // s
  bool soil_limits_friction = true;  // ground takes no more shear than phi = 0 soil carries (soil_limit.hpp)
  double contact_reach = 0.5;        // cells: nodes up to this distance above the ground belong to it
  // 1, nodes under this share of the heaviest mass beside them are continued (surface_extension.hpp); 0: none. Negative
  // in a scene: not given.
  double surface_share = 0.0;
  double local_damping = 0.0;  // 1, Cundall's
  SleepOptions sleep;
  std::vector<Pond> ponds;
  FieldChoice fields;
  FieldContactLaw contact;    // between the fields
  double mass_cutoff = -1.0;  // 1, relative to the mean particle mass; negative: the shape function's own
};

// Work done since the start, J (per metre in plane strain), each counted as energy taken from the particles except
// `external`, `pore_pressure` (frozen pore water pushing expanding soil) and `crowding` (crowded soil pushed apart),
// which were given to them.
//
// `transfer` is the kinetic energy lost between particles and nodes, both ways: sum m v^2 / 2 of the particles before
// P2G minus that of the nodes, plus that of the nodes at the end of the step minus that of the particles after G2P.
// `impact` is what contact impulses J took beside friction: minus J . (v + v') / 2, with the node's velocities before
// and after the step, less friction's share. Both are NaN where momentum and forces come to the nodes as one sum, from
// which the nodes' velocity before the step cannot be told (APIC without damping, FMPM).
// `friction` is that of the ground and of walls, `contact` that between velocity fields.
struct WorkDone {
  double plastic = 0.0, friction = 0.0, contact = 0.0, damping = 0.0, external = 0.0, removed = 0.0,
         pore_pressure = 0.0, crowding = 0.0;
  double transfer = 0.0, impact = 0.0;
};

// Wall-clock seconds by phase since the start.
struct PhaseSeconds {
  double grid = 0.0, grid_to_particles = 0.0, volumetric = 0.0, stress_and_scatter = 0.0, sort = 0.0;
};

struct StepReport {
  double dt = 0.0;              // s, of the step just made
  double next_dt = 0.0;         // s
  double kinetic_energy = 0.0;  // J, sum of m v^2 / 2
  double maximum_speed = 0.0;   // m/s
  bool sorted = false;
  std::size_t asleep = 0;  // particles left out
};

// Smoothed grip of the nodes on the ground (ground_friction.hpp), by blocks.
template <int Dim>
struct GripMemory {
  std::vector<std::array<int, Dim>> blocks;
  std::vector<int> fields;       // of each block
  std::vector<double> smoothed;  // m/s2, Block::nodes per block
};

// What a solver has to remember besides its particles to go on from where it was, bit for bit.
template <int Dim>
struct SolverState {
  std::vector<std::array<int, Dim>> blocks;   // of the last sort, in the order of the particles
  std::vector<std::size_t> first;             // first particle of each block, and their number at the end
  std::vector<double> wave_speed;             // m/s, by material
  double next_dt = 0.0, viscous_limit = 0.0;  // s
  double drift = 0.0;                         // cells, since the last sort
  double fastest_wave = 0.0;                  // m/s
  double kinetic = 0.0;                       // J
  long sorts = 0;
  WorkDone work;
  PhaseSeconds seconds;
  std::array<double, Dim> impulse{};  // N s
  double time = 0.0;                  // s, since the start
  std::vector<BodyState<Dim>> bodies;
  GripMemory<Dim> grip;
  std::vector<std::int32_t> removed, held;  // identities
  std::vector<std::int32_t> meeting;        // by nodes of the active blocks; none with one velocity field
  std::vector<double> sleep_clocks;         // s, of each block; none when nothing may sleep
  std::vector<PondState> ponds;
  std::vector<double> pond_shares;  // PondedWater::shares()
};

template <int Dim>
class Solver {
 public:
  virtual ~Solver() = default;

  // Sorts the particles and puts them on the grid; the first step will be at most `limit` (s) long.
  virtual void start(double limit) = 0;
  // Takes the place of start(): goes on with `particles`, in the order in which particles() gave them, from `state`.
  virtual void resume(Particles<Dim> particles, const SolverState<Dim>& state) = 0;
  virtual SolverState<Dim> state() const = 0;
  // Whether a run that goes on from state() makes the same bits as this one: surfaces between fields are not kept.
  virtual bool resumable() const = 0;
  // Makes one step with body acceleration `body` (gravity, m/s2) and `inertial` (minus the base acceleration); the one
  // after it will be at most `limit` long. Throws ComputationError with the particle, its position, material and the
  // cause when a value is not finite, a particle inverts or moves more than a cell.
  virtual StepReport step(const std::array<double, Dim>& body, const std::array<double, Dim>& inertial,
                          double limit) = 0;

  virtual double next_dt() const = 0;  // s, of the step to be made
  virtual Particles<Dim>& particles() = 0;
  virtual const BlockGrid<Dim>& grid() const = 0;
  virtual const WorkDone& work() const = 0;
  virtual const PhaseSeconds& seconds() const = 0;
  virtual double elastic_energy() const = 0;  // J
  // The particle with the largest kinetic and elastic energy per mass, or one whose energy is not finite, in words for
  // a message: identity, material, position, speed, both energies.
  virtual std::string most_energetic() const = 0;
  virtual double unbalanced_force_ratio(const std::array<double, Dim>& body) const = 0;
  virtual std::array<double, Dim> boundary_impulse() const = 0;   // N s since the start, on the particles
  virtual const std::vector<BodyState<Dim>>& bodies() const = 0;  // in the order of Walls::bodies
  virtual const std::vector<PondState>& ponds() const = 0;        // in the order of SolverOptions::ponds
  virtual std::size_t grid_bytes() const = 0;
  virtual std::vector<std::int32_t> removed() const = 0;  // identities of particles that left
  virtual std::vector<std::int32_t> held() const = 0;     // identities of particles held at a side of the domain
  virtual long sorts() const = 0;
};

// Whether this program is linked to the solver of these options: to every one (all_solvers.cpp), or to the one that
// dams' runouts take (main_solver.cpp).
bool has_solver(int dimension, const SolverOptions& options);

// The particles are moved into the solver. `materials` are in the order of the particles' material numbers; `origin` is
// a node (m). `terrain` must outlive the solver. Only where has_solver.
template <int Dim>
std::unique_ptr<Solver<Dim>> make_solver(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                                         Particles<Dim> particles, const std::vector<Material>& materials,
                                         const Terrain& terrain, const Walls<Dim>& walls);

}  // namespace tailrun::mpm

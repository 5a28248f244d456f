// Everything that mpm.json says, checked and in SI units.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "common/motion.hpp"
#include "common/particles.hpp"
#include "common/residual_strength/strength_tally.hpp"
#include "mpm_stage/boundary/terrain.hpp"
#include "mpm_stage/boundary/walls.hpp"
#include "mpm_stage/material/material.hpp"
#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

struct RestCriterion {
  bool active = true;
  double speed = 0.01;    // m/s, root mean square speed of the moving materials and speed of the front
  double duration = 1.0;  // s, for which both have to hold
  // 1, of the largest kinetic energy so far: with no more than this left for `duration` the flow counts as over. 0:
  // never
  double energy_share = 0.0;
};

struct TrackedPoint {
  std::string name;
  std::array<double, 2> position;  // m, at the start; the nearest particle of a moving material is followed
};

// A vertical section across the flow.
struct FlowSection {
  std::string name;
  double at = 0.0;  // m, along the flow's axis
};

struct OutputOptions {
  double frame_interval = 1.0;  // s of simulated time; 0: no frames
  Precision frame_precision = Precision::full;
  double series_interval = 0.05;  // s
  int front_axis = 0;             // coordinate along which the front runs
  double front_sign = 1.0;        // +1: towards larger coordinates
  double front_quantile = 0.999;  // 1, share of the moving mass behind the robust front
  double body_quantile = 0.9;     // 1, the same of the flow's body
  double flow_distance = 1.0;     // m, what has moved farther than this counts as flowed
  std::optional<double> toe;      // m, where the dam ended before the motion; unless given the outermost moving soil
  std::optional<std::array<double, 2>> footprint;  // m, of the dam along the flow; unless given from crest to toe
  std::vector<TrackedPoint> points;
  std::vector<FlowSection> sections;
};

struct BaseMotion {
  std::optional<Motion> motion;
  double start = 0.0;  // s of the motion at which this run begins
  std::array<double, 3> direction{1, 0, 0};
  bool shaken() const { return motion.has_value(); }
};

// One line of the terrain before its friction has been laid out over the segments.
struct TerrainInput {
  std::string name;
  std::vector<std::array<double, 2>> points;
  std::vector<double> friction;  // per segment
  bool adhere = false;
};

// The strength of soil whose shear strength is all that it has (MaterialLaw::residual_strength), as this run takes it:
// one entry for each material and law that gave it.
struct StrengthInUse {
  std::string material;
  std::string from;  // "hand-over", "mpm.json" (chosen again here), or "cohesion" (of the material)
  std::shared_ptr<const nlohmann::ordered_json> law;  // with all its inputs; null where it is not known
  double factor = 1.0;                                // 1, on what the law gives
  StrengthTally found;      // with that factor in the strengths; bounds are counted where the law was chosen here
  bool has_stress = false;  // whether sigma'_v0 is known
  // Number of particles and sum of sigma'_v0 (Pa) by strength (Pa), of laws that give few; of others it is not
  // complete.
  std::map<double, std::pair<long, double>> steps;
  static constexpr std::size_t most_steps = 12;
};

struct Scene {
  std::string title;
  int dimension = 2;
  double cell_size = 0.0;            // m
  std::array<double, 3> origin{};    // m, a node
  std::array<double, 3> gravity{};   // m/s2
  double end_time = 0.0;             // s, counted from the start of this run
  double checkpoint_interval = 5.0;  // minutes of wall time; 0: none
  SolverOptions solver;
  RestCriterion rest;
  Walls<3> walls;
  std::vector<Material> materials;  // in the order of ParticleSet::material_names
  ParticleSet particles;            // rigid materials already taken out
  std::vector<double> cohesion;     // Pa, per particle
  std::vector<StrengthInUse> strengths;
  // 1/s, (n, 9), d v_i / d x_j at [3 i + j], of particles made here; empty where none is known.
  std::vector<double> velocity_gradient;
  Terrain terrain;
  std::vector<TerrainInput> terrain_lines;
  BaseMotion base;
  OutputOptions output;
  std::vector<std::string> remarks;           // what was left out or assumed, for the summary
  std::vector<std::filesystem::path> inputs;  // every file read besides the case file
  double energy_growth_limit = 0.01;          // 1, of the energy released so far; beyond it the run stops
};

// Reads a scene. `particles_override` takes the place of the case file's "particles_file". Throws InputError.
Scene read_scene(const CaseFile& file, const std::filesystem::path& particles_override, const std::string& size = {});

// Parts of read_scene, each in its own file. The first two read what chooses a solver.
int read_dimension(const CaseNode& root);
void read_scheme(const CaseNode& root, SolverOptions& options);
void read_domain(const CaseNode& root, Scene& scene);
void read_output(const CaseNode& root, Scene& scene);
Material read_material(const std::string& name, const CaseNode& node, double residual_factor);
// The case file's "particles" in scene.particles, with the gradients of the velocities that it gives them.
void generate_particles(const CaseNode& root, const std::vector<Material>& materials, Scene& scene);
std::vector<TerrainInput> read_terrain(const CaseNode& root, const ParticleSet& particles);
// Needs the scene's materials and particles.
void read_contact(const CaseNode& root, Scene& scene);
// Needs the scene's particles, dimension and gravity.
std::vector<Pond> read_ponds(const CaseNode& root, const Scene& scene);
// The scene's ponds with their levels at `time` (s), as a particles file has them; their ranges along x only.
std::vector<PondedReach> ponds_at(const Scene& scene, double time);
std::vector<MovingBody<3>> read_bodies(const CaseNode& root, int dimension);
// Needs the scene's materials and particles. Gives the particles the strengths that "residual_strength" chooses again,
// and the scene its cohesion and strengths; the particles' residual_strength is then what they compute with.
void assign_strength(const CaseFile& file, Scene& scene);

// Whether the particles lie where they can be computed: in the domain, on the material's side of each terrain line, and
// no more of them in a place than it has room for. Throws InputError, or adds to the scene's remarks
// (placement_checks.cpp).
void check_placement(const CaseNode& root, Scene& scene);
// "(x, y) m" for messages.
std::string place_text(const double* x, int dimension);

// Structure of arrays for the solver, in the order of the set (identity = index). `total` materials carry total stress.
template <int Dim>
Particles<Dim> solver_particles(const Scene& scene);

}  // namespace tailrun::mpm

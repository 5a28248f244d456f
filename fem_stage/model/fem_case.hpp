// fem.json as plain data. docs/fem.md lists every key; each is read, checked and defaulted in fem_case.cpp.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/provenance.hpp"
#include "fem_stage/element/sspquadup.hpp"
#include "fem_stage/material/material_points.hpp"
#include "fem_stage/mesh/rectangle_mesh.hpp"
#include "fem_stage/model/boundary_options.hpp"
#include "fem_stage/model/liquefied_strength.hpp"

namespace tailrun::fem {

struct RegionOptions {
  int material = 0;                      // index into FemCase::materials
  std::array<double, 2> permeability{};  // m/s, hydraulic conductivity along x, y
  double thickness = 1.0;                // m
};

struct MeshOptions {
  std::filesystem::path geometry;            // .geo, or
  std::filesystem::path file;                // .msh, or
  std::optional<RectangleMesh> rectangle;    // made here
  std::map<std::string, double> parameters;  // ONELAB numbers for the geometry
  double time_limit = 600.0;                 // s, for gmsh on the geometry
  double snap_to_phreatic_line = 0.0;        // m: nodes nearer than this to the line are moved onto it; 0 = off
};

// How the water pressure before the earthquake is found.
enum class Seepage {
  isotropic,    // steady seepage with one permeability everywhere
  by_region,    // steady seepage with the regions' permeabilities
  hydrostatic,  // rho_f g (level - y) below the phreatic line
};

// The water above the phreatic line.
struct AbovePhreaticLine {
  bool soft_fluid = false;      // false: p = 0 is held there
  double saturation = 0.9;      // S_r of the soft fluid
  bool surface_drained = true;  // p = 0 where the soft fluid meets the ground surface
};

struct GeostaticOptions {
  double K0 = 0.5;       // at-rest ratio of the elastic stage: Poisson ratio K0 / (1 + K0)
  bool yielding = true;  // gravity leaves no stress that the models cannot carry
  Seepage seepage = Seepage::isotropic;
  double settle_time = 0.0;  // s of pseudo-time after the switch to the plastic models
  double settle_step = 0.1;  // s
  double tolerance = 1e-3;   // largest residual force that is accepted at the end, of the weight
};

// The frame that stress and the models' directions live in turns with
enum class Spin {
  polar,    // the rotation R of F = R U (Green & Naghdi 1965)
  jaumann,  // the vorticity: in simple shear half the shear without end
};

struct ShakeOptions {
  std::filesystem::path motion;    // empty: none, loads alone drive the run
  double peak_acceleration = 0.0;  // m/s2, 0 = as recorded
  double duration = 0.0;           // s
  double time_step = 0.005;        // s
  double gamma = 0.6, beta = 0.3025, theta = 0.6;
  double damping_ratio = 0.0, damping_frequency = 0.0;  // stiffness proportional: a1 = 2 zeta / (2 pi f)
  double tolerance = 1e-4;                              // residual force per thickness, of the weight
  int max_iterations = 30;
  int max_halvings = 6;
  int refactor_above = 6;      // iterations of a step after which the matrix is made anew
  int acceleration_depth = 6;  // corrections that Anderson acceleration combines; 0 = off
  bool large_displacement = false;
  Spin spin = Spin::polar;  // of the material's frame, with large displacement
};

// After the shaking: quasi-static steps of growing length.
struct ConsolidationOptions {
  double duration = 86400.0;                                      // s
  double first_step = 0.01, largest_step = 3600.0, growth = 1.5;  // s, s, 1
  double ratio_limit = 0.05;    // r_u: done when no element has more; 0 = run to the end
  double rest_velocity = 0.01;  // m/s: a state that moves faster gets a warning
  double tolerance = 1e-4;      // residual force per thickness, of the weight
  int max_iterations = 50;
  int max_halvings = 10;          // of the first step
  bool post_shaking = true;       // the PM4 models' reconsolidation moduli
  std::vector<double> snapshots;  // s after its start
};

struct NamedPoint {
  std::string name;
  double x, y;  // m
};

struct OutputOptions {
  std::vector<double> snapshots;   // s
  double snapshot_interval = 0.0;  // s, 0 = only the list
  double history_interval = 0.02;  // s
  std::vector<NamedPoint> points, elements;
  std::string liquefaction_region;              // where liquefied depth and mean r_u are measured; empty = off
  std::array<double, 2> liquefaction_window{};  // m, from x to x
  double liquefaction_threshold = 0.7;          // r_u
};

struct FemCase {
  Provenance provenance;
  std::vector<std::filesystem::path> inputs;  // the case and what it names
  std::vector<std::string> echo;
  MeshOptions mesh;
  double gravity = 9.81;              // m/s2
  double fluid_density = 1000.0;      // kg/m3
  double fluid_bulk_modulus = 2.2e9;  // Pa
  std::vector<double> phreatic_line;  // m, (k, 2), ascending x; empty = dry
  AbovePhreaticLine above_phreatic_line;
  double pressure_stabilisation = 0.25;  // alpha = this h^2 / (K + 4 G / 3)
  int pressure_points = 2;
  HourglassShape hourglass_shape = HourglassShape::constant_jacobian;
  bool hourglass_current_modulus = false;
  bool averaged_mass = false;  // half lumped, half consistent
  std::vector<MaterialDefinition> materials;
  std::map<int, LiquefiedStrength> residual_strength;  // by index into materials: those that have one
  std::map<int, Softening> softening;                  // likewise, with a reference height
  std::map<std::string, RegionOptions> regions;
  BoundaryOptions boundaries;
  std::vector<LoadOptions> loads;
  GeostaticOptions geostatic;
  ShakeOptions shake;
  ConsolidationOptions consolidation;
  OutputOptions output;
};

// Throws InputError. `size` chooses from "mesh"/"sizes"; empty takes "default" when there is one.
FemCase read_fem_case(const std::filesystem::path& path, const std::string& size);

}  // namespace tailrun::fem

// The power of stiffness proportional damping is a1 v^T K v.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/solver/element_forces.hpp"

using namespace tailrun::fem;

TEST_CASE("damping: its power is that of the element's whole stiffness, hourglass modes among it") {
  const auto folder = std::filesystem::temp_directory_path() / "tailrun_damping_power_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "fem.json") << R"({
    "mesh": { "rectangle": { "width": 2, "height": 1, "columns": 1, "rows": 1, "region": "soil" } },
    "materials": { "soil": { "model": "linear_elastic", "shear_modulus": 1e7, "density": 1900 } },
    "regions": { "soil": { "material": "soil", "permeability": [0] } },
    "boundaries": { "base": { "line": "bottom", "type": "rigid" } }, "shake": { "duration": 1 } })";
  const FemCase options = read_fem_case(folder / "fem.json", "");
  write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
  Model model = build_model(options, folder / "mesh.msh");
  std::filesystem::remove_all(folder);
  model.mesh.position[2] += 0.3;  // no rectangle: its hourglass modes act on each other
  model.elements = build_sspquadup(model.mesh, {}, model.thickness, options.hourglass_shape, 2);

  constexpr double a1 = 2e-3;  // s
  ElementForces forces(model, a1, false);
  State state;
  state.hourglass_force.assign(2, 0.0);
  const MaterialPoints points = make_material_points(model);
  forces.reset(points, state);
  std::vector<double> bulk(1), shear(1);
  points.elastic_moduli(bulk, shear);

  const std::vector<double> velocity = {0.3, -0.1, 0.7, 0.2, -0.4, 0.5, 0.1, -0.6};
  double stiffness[64], wanted = 0.0;
  sspquadup_stiffness(model.elements, 0, bulk[0], shear[0], shear[0], stiffness);
  for (std::size_t a = 0; a < 8; ++a)
    for (std::size_t b = 0; b < 8; ++b) {
      const auto node = [&](std::size_t k) { return static_cast<std::size_t>(model.mesh.quads[k / 2]); };
      wanted += a1 * velocity[2 * node(a) + a % 2] * stiffness[8 * a + b] * velocity[2 * node(b) + b % 2];
    }
  CHECK(wanted > 0.0);
  CHECK(forces.damping_power(0, velocity) == doctest::Approx(wanted).epsilon(1e-12));
}

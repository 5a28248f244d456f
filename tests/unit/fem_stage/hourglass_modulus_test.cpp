// Hourglass forces that follow the modulus of the last commit: a spring that softens lets go of its force, so that
// softening and hardening make no energy.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "fem_stage/mesh/rectangle_mesh.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/solver/element_forces.hpp"

using namespace tailrun::fem;

TEST_CASE("hourglass modulus 'current': soften, let go, harden, come back: no energy is gained") {
  const auto folder = std::filesystem::temp_directory_path() / "tailrun_hourglass_modulus_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "fem.json")
      << R"({ "mesh": { "rectangle": { "width": 1, "height": 1, "columns": 1, "rows": 1, "region": "soil" } },
             "element": { "hourglass_modulus": "current" },
             "materials": { "soil": { "model": "pm4sand", "relative_density": 0.35, "hpo": 0.5, "density": 1900 } },
             "regions": { "soil": { "material": "soil", "permeability": [0] } },
             "boundaries": { "base": { "line": "bottom", "type": "rigid" } }, "shake": { "duration": 1 } })";
  const FemCase options = read_fem_case(folder / "fem.json", "");
  write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
  const Model model = build_model(options, folder / "mesh.msh");
  MaterialPoints points = make_material_points(model);
  points.set_stress(std::vector<double>{-50e3, -100e3, -50e3, 0.0});
  points.start_plastic_stage(true);
  State state;
  state.displacement.assign(8, 0.0);
  state.pressure.assign(4, 0.0);
  state.hourglass_force.assign(2, 0.0);
  ElementForces forces(model, 0.0, false);
  forces.reset(points, state);
  const std::vector<double> zero(8, 0.0), rate(4, 0.0);
  std::vector<double> residual(12);
  double sxx = 0.0;
  // Hourglass in x by `mode`, expansion by `volume`, both since the last commit.
  const auto move = [&](double mode, double volume) {
    std::vector<double> increment(8);
    for (std::size_t n = 0; n < 4; ++n) {
      const double x = model.mesh.x(n), y = model.mesh.y(n);
      increment[2 * n] = mode * (x - 0.5) * (y - 0.5) + volume * x;
    }
    forces.evaluate(points, increment, zero, state.pressure, rate, residual);
    forces.commit(points, state, increment);
    std::vector<double> bulk(1), shear(1);
    points.elastic_moduli(bulk, shear);
    sxx = shear[0];
    return forces.hourglass_work()[0];
  };
  const double stored = move(1e-4, 0.0), stiff = sxx, first = state.hourglass_force[0];
  CHECK(stored > 0.0);
  move(0.0, 5e-4);
  CHECK(sxx < 0.9 * stiff);
  CHECK(state.hourglass_force[0] == doctest::Approx(first * sxx / stiff));  // let go
  const double soft = state.hourglass_force[0];
  move(0.0, -1.5e-3);
  CHECK(sxx > stiff);
  CHECK(state.hourglass_force[0] == doctest::Approx(soft));  // kept
  CHECK(move(-1e-4, 0.0) > -1e-12);                          // all in all, work was done on it
  std::filesystem::remove_all(folder);
}

// A level beach under horizontal tension, as elastic gravity leaves it behind a dam: what PM4Sand cannot carry of it
// must not turn with the elements, or liquefied rows fold up one against the other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "fem_stage/output/state_file.hpp"
#include "fem_stage/stage/geostatic.hpp"
#include "fem_stage/stage/shake.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

constexpr double tension = 22e3;  // Pa, horizontal, in the top 4 m

struct Beach {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / "tailrun_level_beach_test";
  FemCase options;
  Model model;

  Beach() {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "fem.json")
        << R"({ "mesh": { "rectangle": { "width": 3, "height": 12, "columns": 2, "rows": 16, "region": "tailings" } },
               "phreatic_line": [[0, 12], [3, 12]],
               "materials": { "tailings": { "model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 2.7,
                                            "Q": 11.998, "R": 3.75, "density": 1870 } },
               "regions": { "tailings": { "material": "tailings", "permeability": [1e-6, 1e-9] } },
               "boundaries": { "base": { "line": "bottom", "type": "lysmer_dashpot", "rock_density": 2500,
                                         "rock_shear_velocity": 700 },
                               "periodic_lines": ["left", "right"] },
               "geostatic": { "settle_time": 1, "tolerance": 5e-3 },
               "shake": { "duration": 6, "rayleigh_damping": { "ratio": 0.01, "frequency": 5 },
                          "large_displacement": true } })";
    options = read_fem_case(folder / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
    model = build_model(options, folder / "mesh.msh");
  }
  ~Beach() { std::filesystem::remove_all(folder); }

  struct Result {
    double shear_strain = 0.0, tension_left = 0.0;
  };
  Result shake(bool yielding) const {
    MaterialPoints points = make_material_points(model);
    State state;
    run_geostatic(model, points, state);
    // Any horizontal stress is in balance in level ground.
    for (std::size_t e = 0; e < model.count(); ++e)
      if (model.mesh.centre(e)[1] > 8.0) state.stress[4 * e] = tension;
    points.set_stress(state.stress);
    if (yielding) points.start_yielding_stage();
    points.start_plastic_stage(true);
    points.committed_stress(state.stress);
    state.initial_stress = state.stress;
    Result out;
    for (std::size_t e = 0; e < model.count(); ++e) out.tension_left = std::max(out.tension_left, state.stress[4 * e]);
    Motion motion{.name = "sine", .time_step = 0.005, .acceleration = {}, .velocity = {}};
    double velocity = 0.0;
    for (int i = 0; i < 1200; ++i) {
      const double t = 0.005 * i, a = t < 4.0 ? 1.5 * std::sin(2.0 * 3.14159265358979 * 1.5 * t) : 0.0;
      velocity += 0.005 * a;
      motion.acceleration.push_back(a);
      motion.velocity.push_back(velocity);
    }
    const ShakeReport report = run_shake(model, points, state, motion, folder / "out");
    REQUIRE(report.failure == "");
    for (const double strain : fem::shear_strain(model, state)) out.shear_strain = std::max(out.shear_strain, strain);
    return out;
  }
};

}  // namespace

TEST_CASE("level beach: liquefied rows stay level once gravity has left no tension") {
  const Beach beach;
  const auto offset = beach.shake(false), level = beach.shake(true);
  CHECK(offset.tension_left == doctest::Approx(tension));
  CHECK(level.tension_left <= 0.0);
  CHECK(level.shear_strain < 0.5);
  CHECK(offset.shear_strain > 5.0);
}

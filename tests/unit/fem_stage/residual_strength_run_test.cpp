// "residual_strength" of a material in whole elements: simple shear at large displacement, a shaken column that goes on
// from a file, and what the case file may say.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "fem_stage/output/state_file.hpp"
#include "fem_stage/stage/geostatic.hpp"
#include "fem_stage/stage/liquefaction.hpp"
#include "fem_stage/stage/shake.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

// A column of the main case's tailings, 1 m wide, under 20 kPa and a slope's shear: a load along x on its top.
struct Column {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / "tailrun_residual_strength_test";
  FemCase options;
  Model model;
  MaterialPoints points{{}, {}};
  State state;

  explicit Column(const std::string& residual_strength, int rows = 6) {
    static int made = 0;
    folder += std::to_string(++made);
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "fem.json") << R"({ "mesh": { "rectangle": { "width": 1, "height": )" << rows
                                       << R"(, "columns": 1, "rows": )" << rows << R"(, "region": "soil" } },
               "phreatic_line": [[0, )" << rows
                                       << R"(], [1, )" << rows << R"(]],
               "materials": { "soil": { "model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 2.7,
                                        "Q": 11.998, "R": 3.75, "density": 1870 )"
                                       << residual_strength << R"( } },
               "regions": { "soil": { "material": "soil", "permeability": [1e-6, 1e-9] } },
               "boundaries": { "base": { "line": "bottom", "type": "rigid" }, "periodic_lines": ["left", "right"] },
               "loads": [ { "line": "top", "pressure": 20000 },
                          { "line": "top", "traction": [2500, 0], "stage": "shake",
                            "history": { "type": "ramp", "duration": 1 } } ],
               "geostatic": { "settle_time": 1, "tolerance": 5e-3 },
               "shake": { "duration": 3, "newmark": { "gamma": 0.5, "theta": 0.5 }, "large_displacement": true },
               "output": { "snapshots": [2] } })";
    options = read_fem_case(folder / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
    model = build_model(options, folder / "mesh.msh");
    points = make_material_points(model);
    run_geostatic(model, points, state);
  }
  ~Column() { std::filesystem::remove_all(folder); }

  ShakeReport shake() {
    Motion motion{.name = "sine", .time_step = 0.005, .acceleration = {}, .velocity = {}};
    double velocity = 0.0;
    for (int i = 0; i < 800; ++i) {
      const double a = 2.0 * std::sin(2.0 * 3.14159265358979 * 2.0 * 0.005 * i);
      velocity += 0.005 * a;
      motion.acceleration.push_back(a);
      motion.velocity.push_back(velocity);
    }
    ShakeReport report = run_shake(model, points, state, motion, folder / "out");
    REQUIRE(report.failure == "");
    return report;
  }
  double largest_strain() const {
    double largest = 0.0;
    for (const double strain : fem::shear_strain(model, state)) largest = std::max(largest, strain);
    return largest;
  }
};

const std::string constant = R"(, "residual_strength": { "model": "constant", "strength": 6000, "drained_cap": false)";

}  // namespace

TEST_CASE("residual strength: an element in simple shear to 300 % and back carries it in either frame") {
  for (const char* spin : {"polar", "jaumann"}) {
    Column column(constant + "}", 1);
    column.options.shake.spin = std::string(spin) == "polar" ? Spin::polar : Spin::jaumann;
    const Model& model = column.model;
    State& state = column.state;
    ElementForces forces(model, 0.0, true);
    forces.set_residual_floor(*make_residual_floor(model, state));
    forces.residual_floor()->activate(0);
    forces.reset(column.points, state);
    std::vector<double> increment(2 * model.nodes()), residual(3 * model.nodes());
    double least = 1e300, largest = 0.0;
    const double step = 5e-4;
    for (int k = 1; k <= 12000; ++k) {
      for (std::size_t n = 0; n < model.nodes(); ++n) {
        increment[2 * n] = (k <= 6000 ? step : -step) * model.mesh.y(n);
        increment[2 * n + 1] = 0.0;
        state.displacement[2 * n] += increment[2 * n];
      }
      forces.evaluate(column.points, increment, state.velocity, state.pressure, state.pressure_rate, residual);
      forces.commit(column.points, state, increment);
      if ((k > 1000 && k <= 6000) || k > 7000) {
        const double radius = std::hypot(0.5 * (state.stress[0] - state.stress[1]), state.stress[3]);
        least = std::min(least, radius);
        largest = std::max(largest, radius);
      }
    }
    CAPTURE(spin);
    CHECK(least > 0.98 * 6000.0);
    CHECK(largest < 1.001 * 6000.0);
  }
}

TEST_CASE("residual strength: nothing changes before the trigger, and liquefied soil slides less after it") {
  Column off(""), never(constant + R"(, "trigger": { "excess_pore_pressure_ratio": 2 } })"), on(constant + "}");
  const ShakeReport bare = off.shake();
  CHECK(bare.liquefaction.is_null());
  CHECK(never.shake().liquefaction["soil"]["liquefied_elements"] == 0);
  CHECK(never.state.displacement == off.state.displacement);
  CHECK(never.state.stress == off.state.stress);
  const ShakeReport report = on.shake();
  CHECK(report.liquefaction["soil"]["liquefied_elements"] > 0);
  CHECK(off.largest_strain() > 0.2);
  CHECK(on.largest_strain() < 0.8 * off.largest_strain());
  CHECK(std::abs(report.ledger.residual()) < 0.01 * report.ledger.largest());
  Column strain(constant + R"(, "trigger": { "excess_pore_pressure_ratio": 2, "shear_strain": 0.05 } })");
  CHECK(strain.shake().liquefaction["soil"]["liquefied_elements"] > 0);
}

TEST_CASE("residual strength: a state file goes on") {
  Column one(constant + "}");
  const ShakeReport report = one.shake();
  Column later(constant + "}");
  read_state(one.folder / "out" / report.snapshots.front(), later.model, later.state, later.points);
  CHECK(later.state.floor_stress.size() == 2 * later.model.count());
  later.shake();
  CHECK(later.state.time == doctest::Approx(3.0));
  for (std::size_t i = 0; i < one.state.displacement.size(); ++i)
    CHECK(later.state.displacement[i] == doctest::Approx(one.state.displacement[i]).epsilon(0.01));
  later.options.residual_strength.clear();
  CHECK_THROWS_AS(make_residual_floor(later.model, later.state), InputError);
}

TEST_CASE("softening: nothing changes up to its strain; past it a run goes on from its file and needs its key") {
  const std::string never = R"(, "softening": { "reference_height": 2, "from_shear_strain": 100 })",
                    soon = R"(, "softening": { "reference_height": 2 })";
  Column off(""), late(never), on(soon), resumed(soon);
  off.shake();
  late.shake();
  const ShakeReport report = on.shake();
  CHECK(late.state.displacement == off.state.displacement);
  CHECK(on.state.displacement != off.state.displacement);
  read_state(on.folder / "out" / report.snapshots.front(), resumed.model, resumed.state, resumed.points);
  resumed.shake();
  CHECK(resumed.largest_strain() == doctest::Approx(on.largest_strain()).epsilon(0.01));
  resumed.options.softening.clear();
  CHECK_THROWS_AS(make_softening_scale(resumed.model, resumed.state), InputError);
}

TEST_CASE("residual strength: a case file's mistakes are said with the nearest key") {
  const auto message = [](const std::string& text) -> std::string {
    try {
      Column column(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string key = message(constant + R"(, "mobilization_strain": 0.05 })");
  CHECK(key.find("/materials/soil/residual_strength/mobilization_strain") != std::string::npos);
  CHECK(key.find("mobilisation_strain") != std::string::npos);
  CHECK(message(constant + R"(, "trigger": { "excess_pore_pressure": 0.7 } })").find("excess_pore_pressure_ratio") !=
        std::string::npos);
  CHECK(message(R"(, "residual_strength": { "model": "webber", "blow_count": 6 })").find("weber") != std::string::npos);
  CHECK(message(R"(, "softening": { "height": 1.5 })").find("/materials/soil/softening/height") != std::string::npos);
  CHECK(message(R"(, "residual_strength": { "model": "weber" })").find("blow_count") != std::string::npos);
}

// Simple shear of one linear elastic element to 300 %, against what the two spins give in closed form (Dienes 1979),
// and turns that are no strain.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "common/error.hpp"
#include "fem_stage/mesh/rectangle_mesh.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/solver/element_forces.hpp"

using namespace tailrun::fem;

namespace {

constexpr double G = 3e6;

struct OneElement {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / "tailrun_spin_test";
  FemCase options;
  Model model;
  State state;

  explicit OneElement(const std::string& spin) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "fem.json")
        << R"({ "mesh": { "rectangle": { "width": 1, "height": 1, "columns": 1, "rows": 1, "region": "soil" } },
               "materials": { "soil": { "model": "linear_elastic", "shear_modulus": 3e6, "density": 1900 } },
               "regions": { "soil": { "material": "soil", "permeability": [0] } },
               "boundaries": { "base": { "line": "bottom", "type": "rigid" } },
               "shake": { "duration": 1, "large_displacement": true, "spin": ")"
        << spin << R"(" } })";
    options = read_fem_case(folder / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
    model = build_model(options, folder / "mesh.msh");
    for (auto* array : {&state.displacement, &state.velocity}) array->assign(2 * model.nodes(), 0.0);
    for (auto* array : {&state.pressure, &state.pressure_rate}) array->assign(model.nodes(), 0.0);
    state.hourglass_force.assign(2, 0.0);
    state.stress.assign(4, 0.0);
  }
  ~OneElement() { std::filesystem::remove_all(folder); }

  // Takes the nodes along `path` (x, y, how far in [0, 1]) -> displacement. Returns the stress at the end, tension
  // positive, global axes.
  template <class Path>
  std::array<double, 4> follow(const Path& path, int steps) {
    MaterialPoints points = make_material_points(model);
    ElementForces forces(model, 0.0, true);
    forces.reset(points, state);
    std::vector<double> increment(2 * model.nodes()), residual(3 * model.nodes());
    for (int k = 1; k <= steps; ++k) {
      for (std::size_t n = 0; n < model.nodes(); ++n) {
        const auto u = path(model.mesh.x(n), model.mesh.y(n), static_cast<double>(k) / steps);
        for (std::size_t i = 0; i < 2; ++i) {
          increment[2 * n + i] = u[i] - state.displacement[2 * n + i];
          state.displacement[2 * n + i] = u[i];
        }
      }
      forces.evaluate(points, increment, state.velocity, state.pressure, state.pressure_rate, residual);
      forces.commit(points, state, increment);
    }
    return {state.stress[0], state.stress[1], state.stress[2], state.stress[3]};
  }
};

constexpr double last_shear = 3.0;
std::array<double, 2> simple_shear(double, double y, double share) {
  return {share * last_shear * y, 0.0};
}

}  // namespace

TEST_CASE("spin: simple shear to 300 % has the closed form of either spin") {
  const double jaumann = OneElement("jaumann").follow(simple_shear, 3000)[3];
  CHECK(std::abs(jaumann - G * std::sin(last_shear)) < 2e-3 * G);
  const double polar = OneElement("polar").follow(simple_shear, 3000)[3];
  const double b = std::atan(0.5 * last_shear);
  const double dienes =
      2.0 * G * std::cos(2 * b) * (2 * b - 2.0 * std::tan(2 * b) * std::log(std::cos(b)) - std::tan(b));
  CHECK(polar == doctest::Approx(dienes).epsilon(2e-3));
  CHECK(polar > 10.0 * jaumann);  // the one has come back to nothing, the other rises for ever
}

TEST_CASE("spin: a stressed element that turns by 225 degrees takes its stress along") {
  for (const char* spin : {"jaumann", "polar"}) {
    OneElement element(spin);
    const auto path = [](double x, double y, double share) -> std::array<double, 2> {
      const double stretch = 0.01 * std::min(1.0, 10.0 * share), X = (1.0 + stretch) * x;
      const double turn = std::max(0.0, share - 0.1) / 0.9 * 1.25 * std::numbers::pi;
      return {X * std::cos(turn) - y * std::sin(turn) - x, X * std::sin(turn) + y * std::cos(turn) - y};
    };
    const auto s = element.follow(path, 40000);
    const double nu = 0.3, young = 2.0 * G * (1.0 + nu),
                 normal = young * 0.01 * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)),
                 lateral = normal * nu / (1.0 - nu), turned = 1.25 * std::numbers::pi;
    const double mean = 0.5 * (normal + lateral), half = 0.5 * (normal - lateral);
    CHECK(s[0] == doctest::Approx(mean + half * std::cos(2 * turned)).epsilon(0.05));
    CHECK(s[1] == doctest::Approx(mean - half * std::cos(2 * turned)).epsilon(0.05));
    CHECK(s[3] == doctest::Approx(half * std::sin(2 * turned)).epsilon(0.05));
    CHECK(element.state.rotation[0] == doctest::Approx(turned).epsilon(1e-3));
  }
}

TEST_CASE("spin: a state goes on with the spin that it was made with") {
  OneElement element("jaumann");
  element.follow(simple_shear, 100);
  element.options.shake.spin = Spin::polar;
  MaterialPoints points = make_material_points(element.model);
  ElementForces forces(element.model, 0.0, true);
  CHECK_THROWS_AS(forces.reset(points, element.state), tailrun::InputError);
}

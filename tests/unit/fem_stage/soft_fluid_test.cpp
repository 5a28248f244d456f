// The soft fluid above the phreatic line: its modulus, where it lies, what it holds and how it flows.
#include "fem_stage/model/soft_fluid.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/stage_freedoms.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

// A column of four elements of 1 m with the water level in the middle.
struct Column {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / "tailrun_soft_fluid_test";
  FemCase options;
  Model model;

  explicit Column(const std::string& above, const std::string& line = R"("phreatic_line": [[0, 2], [1, 2]],)") {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "fem.json") << R"({
      "mesh": { "rectangle": { "width": 1, "height": 4, "columns": 1, "rows": 4, "region": "soil" } },)"
                                       << line << R"("above_phreatic_line": {)" << above << R"(},
      "materials": { "soil": { "model": "linear_elastic", "shear_modulus": 1e7, "density": 1900, "porosity": 0.4 } },
      "regions": { "soil": { "material": "soil", "permeability": [1e-6] } },
      "boundaries": { "base": { "line": "bottom", "type": "rigid" } }, "shake": { "duration": 1 } })";
    options = read_fem_case(folder / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
    model = build_model(options, folder / "mesh.msh");
  }
  ~Column() { std::filesystem::remove_all(folder); }
  std::vector<char> held(const Freedoms& freedoms, double y) const {
    std::vector<char> out;
    for (std::size_t n = 0; n < model.nodes(); ++n)
      if (model.mesh.y(n) == y) out.push_back(freedoms.fixed(n, freedom_p));
    return out;
  }
};

const std::vector<char> none = {0, 0}, both = {1, 1};

}  // namespace

TEST_CASE("soft fluid: full of water it is water, full of air it is air, and a little air governs") {
  CHECK(soft_fluid_modulus(1.0, 2.2e9) == doctest::Approx(2.2e9));
  CHECK(soft_fluid_modulus(0.0, 2.2e9) == doctest::Approx(101325.0));
  CHECK(soft_fluid_modulus(0.99, 2.2e9) == doctest::Approx(101325.0 / 0.01).epsilon(0.01));
}

TEST_CASE("soft fluid: only above the line, where the pores give and nothing else is stabilised") {
  const Column column(R"("water": "soft_fluid", "saturation": 0.9)");
  for (std::size_t e = 0; e < 4; ++e) {
    const bool above = column.model.mesh.centre(e)[1] > 2.0;
    CHECK(static_cast<bool>(column.model.soft_fluid[e]) == above);
    CHECK(column.model.storage[e] == doctest::Approx(0.4 / (above ? soft_fluid_modulus(0.9, 2.2e9) : 2.2e9)));
    CHECK((column.model.stabilisation[e] == 0.0) == above);
    CHECK(column.model.pressure_in_stress(e, -5.0) == (above ? 0.0 : -5.0));
    CHECK(column.model.pressure_in_stress(e, 5.0) == 5.0);
  }
}

TEST_CASE("soft fluid: dry at rest, free in the shaking and after it, drained where it meets the surface") {
  const Column column(R"("water": "soft_fluid")");
  const auto rest = geostatic_freedoms(column.model), shaking = shaking_freedoms(column.model),
             after = consolidation_freedoms(column.model);
  for (const double y : {2.0, 3.0}) {
    CHECK(column.held(rest, y) == both);
    CHECK(column.held(shaking, y) == none);
    CHECK(column.held(after, y) == none);
  }
  CHECK(column.held(shaking, 4.0) == both);
  CHECK(column.held(rest, 1.0) == none);
  const Column sealed(R"("water": "soft_fluid", "surface": "sealed")"), drained("");
  CHECK(sealed.held(shaking_freedoms(sealed.model), 4.0) == none);
  CHECK(drained.held(shaking_freedoms(drained.model), 3.0) == both);
}

TEST_CASE("soft fluid: water flows where there is pressure, hardly where there is suction") {
  const Column column(R"("water": "soft_fluid")");
  std::vector<double> pressure(column.model.nodes()), mobility(4, 1.0);
  for (std::size_t n = 0; n < column.model.nodes(); ++n) pressure[n] = 9810.0 * (3.0 - column.model.mesh.y(n));
  soft_fluid_mobility(column.model, pressure, mobility);
  for (std::size_t e = 0; e < 4; ++e)
    CHECK(mobility[e] == (column.model.mesh.centre(e)[1] > 3.0 ? suction_mobility : 1.0));
}

TEST_CASE("soft fluid: a dry model has no line to lie above") {
  CHECK_THROWS_AS(Column(R"("water": "soft_fluid")", ""), InputError);
}

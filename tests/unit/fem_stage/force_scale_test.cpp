// The scale that residuals are measured by: a thick free-field column counts as a slice of it does.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/model/stage_freedoms.hpp"

using namespace tailrun::fem;

namespace {

// Two layers of 1 m, the lower one of the given thickness out of plane; a load of `force` N on the upper left corner.
struct Layers {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / "tailrun_force_scale_test";
  FemCase options;
  Model model;

  Layers(double lower, double upper, double force, const std::string& gravity = "9.81") {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "fem.json") << R"({ "gravity": )" << gravity
                                       << R"(, "mesh": { "rectangle": { "width": 1, "columns": 1, "layers": [
             { "region": "lower", "height": 1, "rows": 1 }, { "region": "upper", "height": 1, "rows": 1 } ] } },
           "materials": { "soil": { "model": "linear_elastic", "shear_modulus": 1e7, "density": 1900 } },
           "regions": { "lower": { "material": "soil", "permeability": [0], "thickness": )"
                                       << lower
                                       << R"( }, "upper": { "material": "soil", "permeability": [0], "thickness": )"
                                       << upper << R"( } }, "loads": [{ "point": [0, 2], "force": [)" << force
                                       << R"(, 0], "stage": "shake" }],
           "boundaries": { "base": { "line": "bottom", "type": "rigid" }, "periodic_lines": ["left", "right"] },
           "shake": { "duration": 1 } })";
    options = read_fem_case(folder / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "mesh.msh");
    model = build_model(options, folder / "mesh.msh");
  }
  ~Layers() { std::filesystem::remove_all(folder); }
};

}  // namespace

TEST_CASE("force scale: the weight per thickness is that of a slice, however thick a part is") {
  const double slice = 1900.0 * 9.81 / 4.0;  // N/m at a corner: one element
  const double wanted = slice * std::sqrt(2.0 * (1.0 + 4.0 + 1.0));
  CHECK(Layers(1.0, 1.0, 0.0).model.weight == doctest::Approx(wanted));
  CHECK(Layers(1000.0, 1.0, 0.0).model.weight == doctest::Approx(wanted));
  CHECK(Layers(1000.0, 1000.0, 0.0).model.weight == doctest::Approx(wanted));
}

TEST_CASE("force scale: loads count over the thickness of their node") {
  CHECK(Layers(1.0, 20.0, 5e6).model.weight == doctest::Approx(5e6 / 20.0));
  CHECK(Layers(1.0, 20.0, 3.0, "0").model.weight == doctest::Approx(3.0 / 20.0));
}

TEST_CASE("force scale: a node between two parts, and nodes that share an equation, have their mass's mean") {
  const Layers layers(100.0, 1.0, 0.0);
  const auto equations = shaking_freedoms(layers.model).number(true, false);
  const auto thickness = equation_thickness(layers.model, equations);
  CHECK(equations.count == 4);
  for (std::size_t n = 0; n < layers.model.nodes(); ++n) {
    const double y = layers.model.mesh.y(n), wanted = y == 0.0 ? 100.0 : y == 1.0 ? 50.5 : 1.0;
    CHECK(layers.model.nodal_thickness[n] == doctest::Approx(wanted));
    const int equation = equations.number[3 * n];
    if (equation >= 0) CHECK(thickness[static_cast<std::size_t>(equation)] == doctest::Approx(wanted));
  }
}

// Loads, histories, rectangles and the refusal of models that nothing holds.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "fem_stage/boundary/nodal_loads.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/model.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "tailrun_boundary_test";
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

Mesh rectangle(const std::filesystem::path& folder, int columns, int rows, double distortion = 0.0) {
  RectangleMesh options;
  options.width = 4.0;
  options.columns = columns;
  options.layers = {{"lower", 2.0, rows}, {"upper", 1.0, rows}};
  options.distortion = distortion;
  write_rectangle_mesh(options, folder / "rectangle.msh");
  return read_gmsh(folder / "rectangle.msh");
}

std::array<double, 2> sum(const std::vector<NodalForce>& forces) {
  std::array<double, 2> total{};
  for (const auto& f : forces) {
    total[0] += f.x;
    total[1] += f.y;
  }
  return total;
}

std::string refusal(const Folder& folder, const std::string& boundaries, const std::string& more = "") {
  std::ofstream(folder.path / "fem.json")
      << R"({
    "mesh": { "rectangle": { "width": 1, "height": 1, "columns": 1, "rows": 1, "region": "soil" } },
    "materials": { "soil": { "model": "linear_elastic", "shear_modulus": 1e7, "density": 1900 } },
    "regions": { "soil": { "material": "soil", "permeability": [1e-6] } },)"
      << more << R"("boundaries": {)" << boundaries << R"(}, "shake": { "duration": 1 } })";
  try {
    const FemCase options = read_fem_case(folder.path / "fem.json", "");
    write_rectangle_mesh(*options.mesh.rectangle, folder.path / "mesh.msh");
    build_model(options, folder.path / "mesh.msh");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("histories: step, ramp, Ricker wavelet, sine and table at known times") {
  CHECK(TimeHistory().at(7.0) == 1.0);
  const auto ramp = TimeHistory::ramp(1.0, 2.0);
  CHECK(ramp.at(1.0) == 0.0);
  CHECK(ramp.at(2.5) == doctest::Approx(0.75));
  CHECK(ramp.at(9.0) == 1.0);
  const auto ricker = TimeHistory::ricker(4.0, 0.5);
  CHECK(ricker.at(0.5) == 1.0);
  CHECK(ricker.at(0.5 + 1.0 / (std::sqrt(2.0) * 3.14159265358979 * 4.0)) == doctest::Approx(0.0).epsilon(1e-12));
  CHECK(TimeHistory::sine(2.0, 1.0).at(1.125) == doctest::Approx(1.0));
  CHECK(TimeHistory::sine(2.0, 1.0).at(0.9) == 0.0);
  const Folder folder;
  std::ofstream(folder.path / "table.csv") << "time,factor\n0,0\n1,2\n4,-4\n";
  const auto table = TimeHistory::table(folder.path / "table.csv");
  CHECK(table.at(0.5) == doctest::Approx(1.0));
  CHECK(table.at(2.0) == doctest::Approx(0.0));
  CHECK(table.at(9.0) == -4.0);
  CHECK(table.largest() == 4.0);
  std::ofstream(folder.path / "table.csv") << "0,0\n1,2\n1,3\n";
  CHECK_THROWS_AS(TimeHistory::table(folder.path / "table.csv"), InputError);
}

TEST_CASE("a pressure on the whole outline sums to nothing, on one side to pressure times area") {
  const Folder folder;
  const Mesh mesh = rectangle(folder.path, 3, 2);
  const std::vector<double> thickness(mesh.elements(), 2.0);
  std::array<double, 2> all{};
  for (const char* line : {"bottom", "right", "top", "left"}) {
    const auto total = sum(line_forces(boundary_edges(mesh, thickness, line, "/loads/0"), {0.0, 0.0}, 50.0));
    all[0] += total[0];
    all[1] += total[1];
    if (std::string(line) == "right") CHECK(total[0] == doctest::Approx(-50.0 * 3.0 * 2.0));
  }
  CHECK(std::abs(all[0]) < 1e-9);
  CHECK(std::abs(all[1]) < 1e-9);
  CHECK_THROWS_AS(boundary_edges(mesh, thickness, "rigth", "/loads/0"), InputError);
}

TEST_CASE("ponded water on a wall: half rho g h^2, at a third of the depth, with an edge that is wetted in part") {
  const Folder folder;
  const Mesh mesh = rectangle(folder.path, 1, 2);
  const std::vector<double> thickness(mesh.elements(), 1.0);
  const double level = 2.3, weight = 9810.0;
  const auto forces = pond_forces(mesh, boundary_edges(mesh, thickness, "left", "/boundaries"), level, weight);
  const auto total = sum(forces);
  CHECK(total[0] == doctest::Approx(0.5 * weight * level * level));
  CHECK(std::abs(total[1]) < 1e-9);
  double moment = 0.0;
  for (const auto& f : forces) moment += f.x * mesh.y(static_cast<std::size_t>(f.node));
  CHECK(moment / total[0] == doctest::Approx(level / 3.0));
}

TEST_CASE("a distorted rectangle keeps its outline and the border between its layers") {
  const Folder folder;
  const Mesh plain = rectangle(folder.path, 5, 3), bent = rectangle(folder.path, 5, 3, 0.25);
  CHECK(bent.region_names.size() == 2);
  int moved = 0;
  for (std::size_t n = 0; n < plain.nodes(); ++n) {
    const bool outline = plain.x(n) == 0.0 || plain.x(n) == 4.0 || plain.y(n) == 0.0 || plain.y(n) == 3.0;
    if (outline) CHECK(plain.x(n) == bent.x(n));
    if (outline || plain.y(n) == 2.0) CHECK(plain.y(n) == bent.y(n));
    moved += plain.x(n) != bent.x(n);
  }
  CHECK(moved == 4 * 5);
  const auto quality = scaled_jacobians(bent, {});
  CHECK(*std::min_element(quality.begin(), quality.end()) > 0.3);
}

TEST_CASE("what nothing holds is refused by name, and so is a boundary that says two things") {
  const Folder folder;
  const std::string bottom = R"("fixed": [{ "line": "bottom", "freedoms": ["x", "y"] }])";
  CHECK(refusal(folder, bottom) == "");
  CHECK(refusal(folder, "").find("nothing holds the model's u_x in the geostatic stage") != std::string::npos);
  CHECK(refusal(folder, R"("roller_lines": ["left"])").find("u_y") != std::string::npos);
  CHECK(refusal(folder, R"("fixed": [{ "line": "bottom", "freedoms": ["x", "y"], "stage": "geostatic" }])")
            .find("shake stage") != std::string::npos);
  CHECK(refusal(folder, R"("fixed": [{ "line": "bottom", "point": [0, 0] }])").find("/boundaries/fixed/0") !=
        std::string::npos);
  CHECK(refusal(folder, R"("fixed": [{ "point": [3, 0] }])").find("at most half an element") != std::string::npos);
  CHECK(refusal(folder, bottom, R"("phreatic_line": [[0, 9], [1, 9]],)").find("nothing holds the water pressure") !=
        std::string::npos);
  CHECK(refusal(folder, bottom, R"("loads": [{ "line": "top", "pressure": 1, "history": { "type": "ramp",
        "duration": 1 } }],)")
            .find("/loads/0/stage") != std::string::npos);
}

// The averaged mass: its difference from the lumped one carries no total and half of the consistent matrix.
#include "fem_stage/solver/averaged_mass.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "fem_stage/mesh/gmsh_mesh.hpp"

using namespace tailrun::fem;

namespace {

Model column(int rows) {
  RectangleMesh rectangle;
  rectangle.width = 2.0;
  rectangle.columns = 1;
  rectangle.layers = {{"soil", 4.0, rows}};
  const auto path = std::filesystem::temp_directory_path() / "tailrun_averaged_mass_test.msh";
  write_rectangle_mesh(rectangle, path);
  Model model;
  model.mesh = read_gmsh(path);
  std::filesystem::remove(path);
  model.thickness.assign(model.count(), 1.0);
  model.density.assign(model.count(), 1900.0);
  model.elements = build_sspquadup(model.mesh, {}, model.thickness, HourglassShape::constant_jacobian, 2);
  std::vector<std::vector<int>> lists(model.nodes());
  for (std::size_t i = 0; i < model.mesh.quads.size(); ++i)
    lists[static_cast<std::size_t>(model.mesh.quads[i])].push_back(static_cast<int>(i));
  model.adjacency_start.assign(1, 0);
  for (const auto& list : lists) {
    model.adjacency.insert(model.adjacency.end(), list.begin(), list.end());
    model.adjacency_start.push_back(static_cast<int>(model.adjacency.size()));
  }
  return model;
}

}  // namespace

TEST_CASE("averaged mass: uniform acceleration and the kinetic energy of uniform motion are the lumped mass's") {
  const Model model = column(5);
  const std::vector<double> uniform(2 * model.nodes(), 3.0);
  std::vector<double> force(2 * model.nodes(), 0.0);
  subtract_averaged_inertia(model, uniform, force);
  for (const double f : force) CHECK(std::abs(f) < 1e-9);
  CHECK(std::abs(averaged_kinetic_difference(model, uniform)) < 1e-9);
}

TEST_CASE("averaged mass: energy of a linear velocity lies half way between the lumped and the exact one") {
  // v = y on 0..4, width 2: exact 1/2 rho 2 (4^3/3); lumped 1/2 rho 2 (trapezoidal rule of y^2).
  const int rows = 5;
  const Model model = column(rows);
  std::vector<double> velocity(2 * model.nodes(), 0.0);
  for (std::size_t n = 0; n < model.nodes(); ++n) velocity[2 * n] = model.mesh.y(n);
  const double h = 4.0 / rows, exact = 1900.0 * 64.0 / 3.0, lumped = exact + 1900.0 * 4.0 * h * h / 6.0;
  CHECK(averaged_kinetic_difference(model, velocity) == doctest::Approx(0.5 * (exact - lumped)));
}

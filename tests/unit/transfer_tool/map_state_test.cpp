#include "transfer_tool/map/map_state.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

double linear(double x, double y) {
  return 3e4 + 7e3 * x - 2.5e4 * y;
}

// Values at the elements' centres of area.
std::vector<double> of_elements(const tailrun::Snapshot& mesh, double (*f)(double, double)) {
  std::vector<double> field;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const Corners corners = initial_corners(mesh, e);
    const NodeWeights integral = integrated_shape_functions(corners);
    double x = 0.0, y = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      x += integral[a] * corners[a][0] / area(corners);
      y += integral[a] * corners[a][1] / area(corners);
    }
    field.push_back(f(x, y));
  }
  return field;
}

}  // namespace

TEST_CASE("a nodal field that is linear in x reaches the points exactly") {
  auto mesh = example::rectangle(5, 4);
  example::set_nodal(mesh, mesh.pore_pressure, 1, 0, linear);
  example::set_nodal(mesh, mesh.velocity, 2, 0, linear);
  example::set_total_stress(mesh);
  for (const Layout layout : {Layout::gauss, Layout::uniform})
    for (int count = 1; count <= 5; ++count) {
      const auto points = example::sample_all(mesh, layout, count);
      const auto state = map_state(mesh, points, {});
      double error = 0.0;
      for (std::size_t p = 0; p < points.count(); ++p) {
        const double exact = linear(points.initial_position[2 * p], points.initial_position[2 * p + 1]);
        error = std::max({error, std::abs(state.pore_pressure[p] - exact), std::abs(state.velocity[2 * p] - exact)});
      }
      CAPTURE(count);
      CHECK(error < 1e-12 * 1.4e5);
    }
}

TEST_CASE("suction that the total stress does not feel stays behind") {
  auto mesh = example::rectangle(2, 4);
  example::set_nodal(mesh, mesh.pore_pressure, 1, 0, [](double, double y) { return 1e4 * (2.0 - y); });
  example::set_total_stress(mesh);
  const std::size_t dry = mesh.elements() - 1, wet = dry - 1;  // side by side in the top row, at a mean of -15 kPa
  for (std::size_t k = 0; k < 3; ++k) mesh.total_stress[4 * dry + k] = mesh.effective_stress[4 * dry + k];
  const auto points = example::sample_all(mesh, Layout::gauss, 2);
  const auto state = map_state(mesh, points, {});
  for (std::size_t p = 0; p < points.count(); ++p) {
    const double exact = 1e4 * (2.0 - points.initial_position[2 * p + 1]);
    const auto element = static_cast<std::size_t>(points.element[p]);
    CHECK(state.pore_pressure[p] == doctest::Approx(element == dry ? 0.0 : exact));
    if (element == wet) CHECK(state.pore_pressure[p] < 0.0);
  }
}

TEST_CASE("the base's velocity is taken off, or kept on request") {
  auto mesh = example::rectangle(2, 2);
  std::fill(mesh.velocity.begin(), mesh.velocity.end(), 0.5);
  mesh.base_velocity = {0.5, 0.2};
  const auto points = example::sample_all(mesh, Layout::gauss, 2);
  MapOptions options;
  auto state = map_state(mesh, points, options);
  CHECK(std::abs(state.velocity[0]) < 1e-15);
  CHECK(state.velocity[1] == doctest::Approx(0.3).epsilon(1e-14));
  options.remove_base_motion = false;
  state = map_state(mesh, points, options);
  CHECK(state.velocity[0] == doctest::Approx(0.5).epsilon(1e-14));
}

TEST_CASE("no recovery lets a value leak from one region into its neighbour, nor overshoots") {
  auto mesh = example::rectangle(6, 6);
  example::Noise noise;
  std::vector<double> field(mesh.elements());
  for (std::size_t e = 0; e < mesh.elements(); ++e) field[e] = mesh.region_id[e] == 0 ? 100.0 + noise() : 1.0 + noise();
  const auto points = example::sample_all(mesh, Layout::uniform, 3);
  for (const Recovery recovery : {Recovery::element, Recovery::nodal, Recovery::linear}) {
    const auto values = recovered(mesh, points, field, 1, recovery);
    // The noise has a range of 2; linear recovery may mirror it about the value of an element on its region's edge.
    const double allowed = recovery == Recovery::linear ? 3.0 : 1.0;
    for (std::size_t p = 0; p < points.count(); ++p) {
      const bool is_lower = mesh.region_id[static_cast<std::size_t>(points.element[p])] == 0;
      CHECK(std::abs(values[p] - (is_lower ? 100.0 : 1.0)) <= allowed);
    }
  }
}

TEST_CASE("linear recovery inside a region stays within the range of the elements around") {
  auto mesh = example::rectangle(8, 8);
  std::fill(mesh.region_id.begin(), mesh.region_id.end(), 0);
  example::Noise noise;
  std::vector<double> field(mesh.elements());
  for (double& value : field) value = noise();
  const auto points = example::sample_all(mesh, Layout::uniform, 3);
  const auto values = recovered(mesh, points, field, 1, Recovery::linear);
  for (std::size_t p = 0; p < points.count(); ++p) {
    const std::int64_t column = points.element[p] % 8, row = points.element[p] / 8;
    if (column % 7 == 0 || row % 7 == 0) continue;
    double low = 1e9, high = -1e9;
    for (std::int64_t i = column - 1; i <= column + 1; ++i)
      for (std::int64_t j = row - 1; j <= row + 1; ++j) {
        low = std::min(low, field[static_cast<std::size_t>(8 * j + i)]);
        high = std::max(high, field[static_cast<std::size_t>(8 * j + i)]);
      }
    CHECK(values[p] >= low - 1e-14);
    CHECK(values[p] <= high + 1e-14);
  }
}

TEST_CASE("nodal recovery differs from the element's value inside a region and keeps a constant one") {
  auto mesh = example::rectangle(4, 4);
  const auto points = example::sample_all(mesh, Layout::gauss, 2);
  const auto constant = recovered(mesh, points, std::vector<double>(mesh.elements(), 7.0), 1, Recovery::nodal);
  for (const double value : constant) CHECK(value == doctest::Approx(7.0).epsilon(1e-14));
  const auto field = of_elements(mesh, linear);
  const auto plain = recovered(mesh, points, field, 1, Recovery::element);
  const auto nodal = recovered(mesh, points, field, 1, Recovery::nodal);
  CHECK(plain[0] == field[0]);
  CHECK(std::abs(nodal[0] - plain[0]) > 1.0);
}

TEST_CASE("linear recovery is exact for a linear field, at the region's edge too") {
  auto mesh = example::rectangle(5, 6, 0.1);
  const auto field = of_elements(mesh, linear);
  const auto points = example::sample_all(mesh, Layout::uniform, 3);
  const auto values = recovered(mesh, points, field, 1, Recovery::linear);
  for (std::size_t p = 0; p < points.count(); ++p)
    CHECK(values[p] ==
          doctest::Approx(linear(points.initial_position[2 * p], points.initial_position[2 * p + 1])).epsilon(1e-11));
}

TEST_CASE("linear recovery keeps the sum of stress times undeformed volume") {
  auto mesh = example::rectangle(5, 6);
  example::Noise noise;
  std::vector<double> field(mesh.elements());
  for (double& value : field) value = noise();
  for (const Layout layout : {Layout::gauss, Layout::uniform}) {
    const auto points = example::sample_all(mesh, layout, 3);
    const auto values = recovered(mesh, points, field, 1, Recovery::linear);
    double before = 0.0, after = 0.0;
    for (std::size_t e = 0; e < mesh.elements(); ++e) before += field[e] * area(initial_corners(mesh, e));
    for (std::size_t p = 0; p < points.count(); ++p) after += values[p] * points.volume[p];
    CHECK(std::abs(after - before) < 1e-12);
  }
}

TEST_CASE("depth is the point's own below the initial surface, or the element's on request") {
  auto mesh = example::rectangle(3, 4, 0.0);
  std::fill(mesh.depth.begin(), mesh.depth.end(), 42.0);
  mesh.displacement[1] = 0.5;  // must not matter
  const auto points = example::sample_all(mesh, Layout::uniform, 2);
  MapOptions options;
  const auto own = map_state(mesh, points, options);
  for (std::size_t p = 0; p < points.count(); ++p)
    CHECK(own.depth[p] == doctest::Approx(4.0 - points.initial_position[2 * p + 1]).epsilon(1e-14));
  options.depth_of_point = false;
  CHECK(map_state(mesh, points, options).depth[0] == 42.0);
}

TEST_CASE("r_u at the transfer or the largest so far") {
  auto mesh = example::rectangle(2, 2);
  std::fill(mesh.excess_pore_pressure_ratio.begin(), mesh.excess_pore_pressure_ratio.end(), 0.4);
  std::fill(mesh.max_excess_pore_pressure_ratio.begin(), mesh.max_excess_pore_pressure_ratio.end(), 0.9);
  const auto points = example::sample_all(mesh, Layout::gauss, 1);
  MapOptions options;
  CHECK(map_state(mesh, points, options).excess_pore_pressure_ratio[0] == 0.4);
  options.maximum_pressure_ratio = true;
  CHECK(map_state(mesh, points, options).excess_pore_pressure_ratio[0] == 0.9);
}

TEST_CASE("a geostatic file renews sigma'_v0 and r_u, and must be of the same mesh") {
  auto mesh = example::rectangle(2, 2), geostatic = mesh;
  std::fill(mesh.pore_pressure.begin(), mesh.pore_pressure.end(), 60e3);
  std::fill(mesh.excess_pore_pressure_ratio.begin(), mesh.excess_pore_pressure_ratio.end(), 0.1);
  std::fill(geostatic.pore_pressure.begin(), geostatic.pore_pressure.end(), 40e3);
  for (std::size_t e = 0; e < 4; ++e) geostatic.effective_stress[4 * e + 1] = -50e3;
  take_initial_state(mesh, geostatic);
  CHECK(mesh.initial_vertical_effective_stress[3] == 50e3);
  CHECK(mesh.excess_pore_pressure_ratio[3] == doctest::Approx(0.4).epsilon(1e-14));
  CHECK(mesh.initial_pore_pressure[3] == doctest::Approx(40e3));
  auto other = example::rectangle(3, 2);
  CHECK_THROWS_AS(take_initial_state(mesh, other), tailrun::InputError);
  geostatic.position[0] += 0.01;
  CHECK_THROWS_AS(take_initial_state(mesh, geostatic), tailrun::InputError);
}

#include "transfer_tool/sample/sample.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "common/error.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

TEST_CASE("points carry the element's mass and deformed volume for both layouts and every count") {
  auto mesh = example::rectangle(4, 4);
  example::set_motion(mesh);
  for (const Layout layout : {Layout::gauss, Layout::uniform})
    for (int count = 1; count <= 5; ++count) {
      const auto points = example::sample_all(mesh, layout, count);
      REQUIRE(points.count() == mesh.elements() * static_cast<std::size_t>(count * count));
      std::vector<double> mass(mesh.elements()), volume(mesh.elements());
      for (std::size_t p = 0; p < points.count(); ++p) {
        mass[static_cast<std::size_t>(points.element[p])] += points.mass[p];
        volume[static_cast<std::size_t>(points.element[p])] += points.volume[p];
      }
      for (std::size_t e = 0; e < mesh.elements(); ++e) {
        CHECK(std::abs(mass[e] / (mesh.density[e] * area(initial_corners(mesh, e))) - 1.0) < 1e-13);
        CHECK(std::abs(volume[e] / area(deformed_corners(mesh, e)) - 1.0) < 1e-13);
      }
    }
}

TEST_CASE("uniform points of a rectangle are the centres of equal cells") {
  const auto mesh = example::rectangle(1, 2, 0.0);
  const auto points = sample(mesh, {true, false}, example::sampling(Layout::uniform, 2));
  REQUIRE(points.count() == 4);
  for (std::size_t p = 0; p < 4; ++p) {
    CHECK(points.volume[p] == doctest::Approx(0.25).epsilon(1e-14));
    CHECK(std::abs(std::abs(points.position[2 * p] - 0.5) - 0.25) < 1e-14);
    CHECK(std::abs(std::abs(points.position[2 * p + 1] - 0.5) - 0.25) < 1e-14);
  }
}

TEST_CASE("Gauss points of a square lie at the rule's places") {
  const auto mesh = example::rectangle(1, 2, 0.0);
  const auto points = sample(mesh, {true, false}, example::sampling(Layout::gauss, 2));
  CHECK(points.position[0] == doctest::Approx(0.5 - 0.5 / std::sqrt(3.0)).epsilon(1e-14));
  CHECK(points.position[1] == doctest::Approx(0.5 - 0.5 / std::sqrt(3.0)).epsilon(1e-14));
}

TEST_CASE("automatic counts follow the cell size, along each side of its own") {
  SamplingOptions options = example::sampling(Layout::uniform, 0);
  options.cell_size = 1.0;
  options.points_per_cell = 4.0;
  const Corners slab = {{{0, 0}, {10, 0}, {10, 1}, {0, 1}}};
  CHECK(points_in_element(slab, options, 0) == std::array<double, 2>{20, 2});
  options.layout = Layout::gauss;
  CHECK(points_in_element(slab, options, 0) == std::array<double, 2>{5, 5});
  options.cell_size = 100.0;
  CHECK(points_in_element(slab, options, 0) == std::array<double, 2>{1, 1});
}

TEST_CASE("kept elements: regions and the clip by element centres") {
  const auto mesh = example::rectangle(4, 2, 0.0);
  SamplingOptions options = example::sampling(Layout::gauss, 1);
  options.kept_region = {false, true};
  options.clip_x = {1.0, 3.0};
  const auto kept = kept_elements(mesh, options);
  CHECK(kept == std::vector<bool>{false, false, false, false, false, true, true, false});
}

TEST_CASE("an element inverted by its displacement is an error, or keeps its initial volume on request") {
  auto mesh = example::rectangle(2, 2, 0.0);
  mesh.displacement[2 * 4] = 3.0;  // the middle node
  auto options = example::sampling(Layout::gauss, 2);
  const std::vector<bool> kept(4, true);
  const auto message = example::message_of<tailrun::InputError>([&] { sample(mesh, kept, options); });
  CHECK(message.find("inverted at t") != std::string::npos);
  CHECK(message.find("region 'lower'") != std::string::npos);
  options.inverted = InvertedElements::initial_volume;
  const auto points = sample(mesh, kept, options);
  for (const double volume : points.volume) CHECK(volume > 0.0);
  const double mass = std::accumulate(points.mass.begin(), points.mass.end(), 0.0);
  CHECK(mass == doctest::Approx(2 * 1800.0 + 2 * 2000.0).epsilon(1e-13));
}

TEST_CASE("nothing left to sample is an error") {
  const auto mesh = example::rectangle(2, 2);
  CHECK_THROWS_AS(sample(mesh, std::vector<bool>(4, false), example::sampling(Layout::gauss, 2)), tailrun::InputError);
}

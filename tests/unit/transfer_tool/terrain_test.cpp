#include "transfer_tool/sample/terrain.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/error.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

TerrainOptions lower_is_bed() {
  TerrainOptions options;
  options.region = {true, false};
  return options;
}

std::vector<bool> upper_elements(const tailrun::Snapshot& mesh) {
  std::vector<bool> kept;
  for (const auto region : mesh.region_id) kept.push_back(region == 1);
  return kept;
}

}  // namespace

TEST_CASE("the bed is the interface in the deformed geometry, with the kept material on its left") {
  auto mesh = example::rectangle(5, 4);
  example::set_motion(mesh);
  const auto lines = terrain_lines(mesh, upper_elements(mesh), lower_is_bed());
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].name == "bed");
  REQUIRE(lines[0].points.size() == 12);
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t node = 12 + i;
    CHECK(lines[0].points[2 * i] == mesh.position[2 * node] + mesh.displacement[2 * node]);
    CHECK(lines[0].points[2 * i + 1] == mesh.position[2 * node + 1] + mesh.displacement[2 * node + 1]);
  }
}

TEST_CASE("the bed goes on over the open ground beside the kept material, and to where it is extended") {
  auto mesh = example::rectangle(6, 2, 0.0);
  // take away the upper elements of the right half: the lower ones there have a free surface
  tailrun::Snapshot cut = mesh;
  cut.quads.erase(cut.quads.begin() + 4 * 9, cut.quads.end());
  cut.region_id.resize(9);
  std::vector<bool> kept = {false, false, false, false, false, false, true, true, true};
  TerrainOptions options = lower_is_bed();
  options.extend = true;
  options.downstream_to = 26.0;
  options.downstream_slope = 45.0;
  const auto lines = terrain_lines(cut, kept, options);
  REQUIRE(lines.size() == 1);
  REQUIRE(lines[0].points.size() == 16);
  CHECK(lines[0].points[0] == 0.0);
  CHECK(lines[0].points[12] == 6.0);
  CHECK(lines[0].points[13] == 1.0);
  CHECK(lines[0].points[14] == 26.0);
  CHECK(lines[0].points[15] == doctest::Approx(-19.0));
  options.downstream_to = 3.0;
  CHECK_THROWS_AS(terrain_lines(cut, kept, options), tailrun::InputError);
}

TEST_CASE("walls stand where the mesh goes on without particles, walked with these on the left") {
  auto mesh = example::rectangle(6, 4, 0.0);
  auto kept = upper_elements(mesh);
  for (std::size_t e = 0; e < kept.size(); ++e)
    if (e % 6 == 0 || e % 6 == 5) kept[e] = false;
  TerrainOptions options = lower_is_bed();
  options.wall_height = 3.0;
  const auto lines = wall_lines(mesh, kept, options);
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].name == "upstream_wall");
  CHECK(lines[0].points == std::vector<double>{1, 7, 1, 4, 1, 3, 1, 2});
  CHECK(lines[1].name == "downstream_wall");
  CHECK(lines[1].points == std::vector<double>{5, 2, 5, 3, 5, 4, 5, 7});
}

TEST_CASE("depth below an uneven ground surface") {
  auto mesh = example::rectangle(4, 2, 0.0);
  for (std::size_t node = 10; node < 15; ++node)
    mesh.position[2 * node + 1] += 0.25 * mesh.position[2 * node];  // the top row
  const GroundSurface surface(mesh);
  for (const double x : {0.0, 0.3, 1.0, 2.71, 4.0}) CHECK(surface.height(x) == doctest::Approx(2.0 + 0.25 * x));
  CHECK(surface.depth(2.0, 1.0) == doctest::Approx(1.5));
  CHECK(surface.height(9.0) == doctest::Approx(3.0));
}

TEST_CASE("a bed without a surface is an error") {
  const auto mesh = example::rectangle(2, 2);
  TerrainOptions options;
  options.region = {false, false};
  CHECK_THROWS_AS(terrain_lines(mesh, upper_elements(mesh), options), tailrun::InputError);
}

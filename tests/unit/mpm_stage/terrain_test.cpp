#include "mpm_stage/boundary/terrain.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "mpm_stage/boundary/ground_friction.hpp"

using namespace tailrun::mpm;

TEST_CASE("distance to an inclined line is the normal distance, positive on its left") {
  Terrain t;
  t.add_line({{{0.0, 0.0}}, {{4.0, -3.0}}}, {0.3}, false);
  CHECK(t.distance(3.0, 4.0) == doctest::Approx(5.0));
  CHECK(t.distance(-3.0, -4.0) == doctest::Approx(-5.0));
  CHECK(t.distance(40.0 + 0.6, -30.0 + 0.8) == doctest::Approx(1.0));  // beyond the end it goes on
}

TEST_CASE("a bed that turns: convex corners have round distances, re-entrant ones two contacts") {
  Terrain ridge, valley;
  ridge.add_line({{{-5.0, -5.0}}, {{0.0, 0.0}}, {{5.0, -5.0}}}, {0.1, 0.2}, false);
  CHECK(ridge.distance(0.0, 2.0) == doctest::Approx(2.0));
  CHECK(ridge.distance(0.0, -1.0) == doctest::Approx(-std::sqrt(0.5)));
  valley.add_line({{{-5.0, 5.0}}, {{0.0, 0.0}}, {{5.0, 5.0}}}, {0.1, 0.2}, false);
  std::array<TerrainPoint, 2> found;
  bool adhere = false;
  CHECK(valley.contacts(0.05, 0.1, 0.5, found, adhere) == 2);
  CHECK(found[0].normal[0] * found[1].normal[0] < 0.0);
  CHECK(ridge.contacts(0.0, 0.3, 0.5, found, adhere) == 1);
}

TEST_CASE("stopping the approach leaves sliding, friction takes its share and never reverses it") {
  NodeContact c;
  c.count = 1;
  c.point[0] = {0.0, {0.0, 1.0}, 0.5};
  std::array<double, 2> v = {3.0, -2.0};
  const NodeGrip grip = stop_approach<2>(c, 10.0, 0.0, v);
  CHECK(v[1] == 0.0);
  CHECK(grip.friction == doctest::Approx(0.5 * 10.0 * 2.0));
  const double lost = apply_friction<2>(grip, grip.friction, v);
  CHECK(v[0] == doctest::Approx(2.0));
  CHECK(lost == doctest::Approx(10.0 * 1.0 * 2.0));
  apply_friction<2>(grip, 1e9, v);
  CHECK(v[0] == doctest::Approx(0.0));
}

TEST_CASE("an open gap lets material come down at the speed that closes it") {
  NodeContact c;
  c.count = 1;
  c.point[0] = {0.0, {0.0, 1.0}, 0.5};
  std::array<double, 2> v = {0.0, -2.0};
  stop_approach<2>(c, 1.0, 1.5, v);
  CHECK(v[1] == doctest::Approx(-1.5));
  std::array<double, 2> slow = {0.0, -1.0};
  CHECK(stop_approach<2>(c, 1.0, 1.5, slow).mass == 0.0);
  CHECK(slow[1] == -1.0);
}

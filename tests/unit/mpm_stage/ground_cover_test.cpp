// What soil covers of the ground's surface.
#include "mpm_stage/boundary/ground_cover.hpp"

#include <doctest/doctest.h>

#include "mpm_stage/boundary/covered_ground.hpp"
#include "mpm_stage/boundary/ground_surface.hpp"

using namespace tailrun::mpm;

namespace {

constexpr int nodes = 16, bins = GroundCover<2>::bins;

// Cells of level ground that the nodes of its row have under the particles at `places`, each `size` wide.
double covered(const std::vector<double>& places, double size) {
  Terrain ground;
  ground.add_line({{{-100.0, 4.0}}, {{100.0, 4.0}}}, {0.5}, false);
  const GroundSurface<nodes, bins> surface(ground, 0.0, 0.0, 1.0);
  double sum = 0.0;
  for (int j = 3; j <= 5; ++j)
    for (int i = 0; i < nodes; ++i) {
      GroundShare<2> share{.axis = 0, .whole = surface[j * nodes + i], .part = surface.parts(j * nodes + i, 0)};
      GroundCover<2> soil;
      for (const double x : places) {
        const double X[2] = {x, 4.25};
        const int node[2] = {i, j};
        soil |= CoveredGround<2, 1>(X, node, size, 0.25, {0.0, 1.0}).from(0, 0, 0);
      }
      sum += share.under(soil);
    }
  return sum;
}

std::vector<double> row(double from, int count, double step) {
  std::vector<double> places;
  for (int k = 0; k < count; ++k) places.push_back(from + (k + 0.5) * step);
  return places;
}

}  // namespace

TEST_CASE("soil covers its own length of the ground, wherever its ends lie in a cell") {
  for (const double from : {4.0, 4.13, 4.37, 4.5, 4.81}) {
    CAPTURE(from);
    CHECK(covered(row(from, 8, 0.5), 0.5) == doctest::Approx(4.0).epsilon(0.03));
    CHECK(covered(row(from, 2, 0.5), 0.5) == doctest::Approx(1.0).epsilon(0.13));
  }
}

TEST_CASE("holes between particles are none, what lies two cells apart is") {
  auto places = row(4.0, 8, 0.5);
  places.erase(places.begin() + 3);
  CHECK(covered(places, 0.5) == doctest::Approx(4.0).epsilon(0.03));
  auto apart = row(4.0, 4, 0.5);
  for (const double x : row(8.5, 4, 0.5)) apart.push_back(x);
  CHECK(covered(apart, 0.5) == doctest::Approx(4.0).epsilon(0.06));
}

TEST_CASE("what is more than a cell above the ground covers nothing") {
  const double X[2] = {5.0, 5.2};
  const int node[2] = {5, 4};
  CHECK(CoveredGround<2, 1>(X, node, 0.5, 1.2, {0.0, 1.0}).from(0, 0, 0).along[0] == 0);
}

TEST_CASE("what soil on a slope covers is its foot, straight below it against the slope") {
  const double c = std::cos(0.4), s = std::sin(0.4), X[2] = {5.0, 5.0};
  const int node[2] = {5, 5};
  const auto seen = CoveredGround<2, 1>(X, node, 0.5, 0.8, {s, c}).from(0, 0, 0);
  GroundCover<2>::Bits wanted;
  GroundCover<2>::Line::under<1>(-0.8 * s, 0.25 * c, &wanted);
  CHECK(seen.along[0] == wanted);
}

TEST_CASE("on a slope soil covers what lies across from it") {
  Terrain ground;
  const double c = std::cos(0.4), s = std::sin(0.4);
  ground.add_line({{{-100.0 * c, 8.0 + 100.0 * s}}, {{100.0 * c, 8.0 - 100.0 * s}}}, {0.5}, false);
  const GroundSurface<nodes, bins> surface(ground, 0.0, 0.0, 1.0);
  double sum = 0.0;
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i) {
      const GroundShare<2> share{.axis = 0, .whole = surface[j * nodes + i], .part = surface.parts(j * nodes + i, 0)};
      GroundCover<2> soil;
      for (const double along : row(6.0, 8, 0.5)) {
        const double X[2] = {along * c + 0.25 * s, 8.0 - along * s + 0.25 * c};
        const int node[2] = {i, j};
        soil |= CoveredGround<2, 1>(X, node, 0.5, 0.25, {s, c}).from(0, 0, 0);
      }
      sum += share.under(soil);
    }
  CHECK(sum == doctest::Approx(4.0).epsilon(0.03));
}

TEST_CASE("in three dimensions soil covers its own area") {
  Terrain ground;
  ground.add_line({{{-100.0, 4.0}}, {{100.0, 4.0}}}, {0.5}, false);
  const GroundSurface<nodes, GroundCover<3>::bins> surface(ground, 0.0, 0.0, 1.0);
  for (const double from : {4.0, 4.2, 4.4}) {
    CAPTURE(from);
    double sum = 0.0;
    for (int k = 0; k < nodes; ++k)
      for (int j = 3; j <= 5; ++j)
        for (int i = 0; i < nodes; ++i) {
          const GroundShare<3> share{
              .axis = 0, .whole = surface[j * nodes + i], .part = surface.parts(j * nodes + i, 0)};
          GroundCover<3> soil;
          for (const double x : row(from, 8, 0.5))
            for (const double z : row(from, 6, 0.5)) {
              const double X[3] = {x, 4.25, z};
              const int node[3] = {i, j, k};
              soil |= CoveredGround<3, 1>(X, node, 0.5, 0.25, {0.0, 1.0, 0.0}).from(0, 0, 0);
            }
          sum += share.under(soil);
        }
    CHECK(sum == doctest::Approx(12.0).epsilon(0.06));
  }
}

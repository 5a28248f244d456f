// How far a start is out of balance: what the ground bears counts for nothing.
#include <doctest/doctest.h>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

// Of a level layer, 20 x 6 m between slipping sides, geostatic but for `factor`, on ground `lift` cells above a row of
// nodes.
double unbalanced(double lift, double factor) {
  constexpr double g = 9.81, density = 2000.0, cell = 1.0, spacing = 0.5, thickness = 6.0;
  constexpr std::size_t wide = 40, high = 12;
  const double ground = lift * cell;
  Particles<2> P;
  P.resize(wide * high, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double up = (static_cast<double>(p / wide) + 0.5) * spacing;
    P.position[0][p] = (static_cast<double>(p % wide) + 0.5) * spacing;
    P.position[1][p] = ground + up;
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
    for (int k = 0; k < 3; ++k) P.stress[k][p] = -factor * density * g * (thickness - up);
  }
  Material soil;
  soil.name = "soil";
  soil.law = &law_named("linear_elastic");
  soil.youngs_modulus = 1e7;
  soil.poisson_ratio = 0.3;
  Terrain bed;
  bed.add_line({{{-1000.0, ground}}, {{1000.0, ground}}}, {0.5}, false);
  Walls<2> walls;
  walls.bounded = true;
  walls.low = {0.0, -4.0};
  walls.high = {20.0, 16.0};
  for (auto& side : walls.side[0]) side.kind = WallKind::slip;
  const auto s = make_solver<2>({}, cell, walls.low, std::move(P), {soil}, bed, walls);
  s->start(1e30);
  return s->unbalanced_force_ratio({0.0, -g});
}

}  // namespace

TEST_CASE(
    "a geostatic layer is in balance wherever the ground lies between rows of nodes, and half of its stress is not") {
  for (const double lift : {0.0, 0.25, 0.45, 0.5, 0.7}) {
    CAPTURE(lift);
    CHECK(unbalanced(lift, 1.0) < 0.1);
    CHECK(unbalanced(lift, 0.5) == doctest::Approx(0.5).epsilon(0.2));
  }
}

// What time/courant may be for a particle alone on its nodes (scene_reader.cpp, warn_of_long_steps).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

// What the breathing of a lone particle, begun with 1e-3 1/s, grows to in 400 steps (times).
double growth(double courant, double place) {
  constexpr double h = 1.0;
  Particles<2> P;
  P.resize(1, true, false);
  for (int d = 0; d < 2; ++d) {
    P.position[d][0] = 8.0 + place;  // cells from a node
    P.affine[d * 3][0] = 1e-3;
  }
  P.volume[0] = 0.25 * h * h;
  P.mass[0] = 1870.0 * P.volume[0];
  P.strength[0] = 1e9;
  Material clay;
  clay.name = "clay";
  clay.law = &law_named("tresca");
  clay.youngs_modulus = 5e6;
  clay.poisson_ratio = 0.49;
  SolverOptions o;
  o.courant = courant;
  const Terrain none;
  const auto s = make_solver<2>(o, h, {}, std::move(P), {clay}, none, Walls<2>{});
  s->start(1e30);
  double most = 0.0;
  for (int n = 0; n < 400 && most < 1.0; ++n) {
    s->step({}, {}, 1e30);
    most = std::max(most, std::fabs(s->particles().affine[0][0]));
  }
  return most / 1e-3;
}

}  // namespace

TEST_CASE("a lone particle's breathing does not grow up to courant 0.5, wherever it is in its cell, and does beyond") {
  for (const double place : {0.0, 0.1, 0.25, 0.4, 0.45, 0.48, 0.5, 0.75}) {
    CAPTURE(place);
    CHECK(growth(0.5, place) < 2.0);
    CHECK(growth(0.8, place) > 100.0);
  }
  CHECK(growth(0.55, 0.45) > 100.0);
}

// What time/courant may be for a particle alone on its nodes (step/lone_particle.hpp).
#include <doctest/doctest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/lone_particle.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

// What the breathing of a lone particle, begun with 1e-3 1/s, grows to in 400 steps (times).
double growth(double courant, double place, ShapeName shape = ShapeName::quadratic) {
  constexpr double h = 1.0;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // for one particle
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
  o.shape = shape;
  const Terrain none;
  const auto s = make_solver<2>(o, h, {}, std::move(P), {clay}, none, Walls<2>{});
  s->start(1e30);
  double most = 0.0;
  for (int n = 0; n < 400 && most < 1.0; ++n) {
    s->step({}, {}, 1e30);
    most = std::max(most, std::fabs(s->particles().affine[0][0]));
  }
  omp_set_num_threads(threads);
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

TEST_CASE("with linear functions and GIMP, too, a lone particle bears the longest step and not a tenth more") {
  for (const auto& [shape, longest] : {std::pair{ShapeName::linear, longest_courant<LinearShape>(2)},
                                       std::pair{ShapeName::gimp, longest_courant<GimpShape>(2)}}) {
    CAPTURE(static_cast<int>(shape));
    double within = 0.0, beyond = 0.0;
    for (double place = 0.0; place < 1.0; place += 0.03125) {
      within = std::max(within, growth(0.97 * longest, place, shape));
      beyond = std::max(beyond, growth(1.1 * longest, place, shape));
    }
    CHECK(within < 6.0);
    CHECK(beyond > 100.0);
  }
}

TEST_CASE("with linear functions a block whose particles lie on lines of nodes stays where it stands") {
  constexpr double h = 0.5, spacing = 0.25, density = 2000.0, g = 9.81, height = 2.0;
  constexpr int wide = 17, high = 8;
  Particles<2> P;
  P.resize(wide * high, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = spacing * static_cast<double>(p % wide);
    P.position[1][p] = spacing * static_cast<double>(p / wide);
    P.identity[p] = static_cast<std::int32_t>(p);
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    const double depth = height - P.position[1][p] - 0.5 * spacing;
    for (int k = 0; k < 3; ++k) P.stress[k][p] = (k == 1 ? -1.0 : -0.5) * density * g * depth;
  }
  Terrain bed;
  bed.add_line({{{-10.0, 0.0}}, {{10.0, 0.0}}}, {0.5}, false);
  Material soil;
  soil.name = "soil";
  soil.law = &law_named("linear_elastic");
  soil.youngs_modulus = 1e7;
  soil.poisson_ratio = 0.3;
  SolverOptions o;
  o.shape = ShapeName::linear;
  o.courant = longest_courant<LinearShape>(2);
  const auto s = make_solver<2>(o, h, {}, std::move(P), {soil}, bed, Walls<2>{});
  s->start(1e30);
  for (double time = 0.0; time < 1.0;) time += s->step({0.0, -g}, {}, 1e30).dt;
  // Half of a particle hangs over the sides, so the block settles and rings a little.
  for (std::size_t p = 0; p < s->particles().count(); ++p) {
    const auto at = static_cast<std::size_t>(s->particles().identity[p]);
    CHECK(std::fabs(s->particles().position[0][p] - spacing * static_cast<double>(at % wide)) < 0.01);
    CHECK(std::fabs(s->particles().position[1][p] - spacing * static_cast<double>(at / wide)) < 0.02);
  }
}

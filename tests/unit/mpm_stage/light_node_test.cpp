// Linear shape functions: nodes that hardly hold anything must not throw their particles about (shape_functions.hpp).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

// The fastest that a free elastic block, begun with 1 mm/s of stretch per metre, has been in 300 steps, m/s. Its
// outermost particles are `beyond` (cells) over a line of nodes.
double fastest(double beyond, double courant, double cutoff) {
  constexpr double h = 1.0;
  constexpr int side = 9;
  Particles<2> P;
  P.resize(side * side, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double x[] = {0.5 * static_cast<double>(p % side) - 2.0, 0.5 * static_cast<double>(p / side) - 2.0};
    for (int d = 0; d < 2; ++d) {
      P.position[d][p] = 10.0 + beyond + x[d];
      P.velocity[d][p] = 1e-3 * x[d];
    }
    P.volume[p] = 0.25 * h * h;
    P.mass[p] = 2000.0 * P.volume[p];
  }
  Material rubber;
  rubber.name = "rubber";
  rubber.law = &law_named("linear_elastic");
  rubber.youngs_modulus = 1e7;
  rubber.poisson_ratio = 0.3;
  SolverOptions o;
  o.shape = ShapeName::linear;
  o.courant = courant;
  o.mass_cutoff = cutoff;
  const Terrain none;
  const auto s = make_solver<2>(o, h, {}, std::move(P), {rubber}, none, Walls<2>{});
  s->start(1e30);
  double most = 0.0;
  for (int n = 0; n < 300 && most < 1.0; ++n) {
    s->step({}, {}, 1e30);
    for (std::size_t p = 0; p < s->particles().count(); ++p)
      most = std::max({most, std::fabs(s->particles().velocity[0][p]), std::fabs(s->particles().velocity[1][p])});
  }
  return most;
}

// m/s, of a particle alone in the middle of its cell beside a heavy block, after falling for a second.
template <int Dim>
double speed_of_lone() {
  constexpr double h = 1.0;
  constexpr std::size_t block = 1 << Dim;
  Particles<Dim> P;
  P.resize(block + 1, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (int d = 0; d < Dim; ++d) P.position[d][p] = p == block ? 20.5 : 10.25 + 0.5 * static_cast<double>(p >> d & 1);
    P.volume[p] = std::pow(0.5 * h, Dim);
    P.mass[p] = (p == block ? 1000.0 : 4000.0) * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  Material rubber;
  rubber.name = "rubber";
  rubber.law = &law_named("linear_elastic");
  rubber.youngs_modulus = 1e7;
  rubber.poisson_ratio = 0.3;
  SolverOptions o;
  o.shape = ShapeName::linear;
  const Terrain none;
  const auto s = make_solver<Dim>(o, h, {}, std::move(P), {rubber}, none, Walls<Dim>{});
  s->start(1e30);
  std::array<double, Dim> gravity{};
  gravity[1] = -10.0;
  for (double time = 0.0; time < 1.0;) {
    const double dt = s->next_dt();
    s->step(gravity, {}, 1.0 - time - dt);
    time += dt;
  }
  for (std::size_t p = 0; p < s->particles().count(); ++p)
    if (s->particles().identity[p] == static_cast<std::int32_t>(block)) return s->particles().velocity[1][p];
  return 0.0;
}

}  // namespace

TEST_CASE("linear shape functions: a light particle alone in its cell falls") {
  CHECK(speed_of_lone<2>() == doctest::Approx(-10.0).epsilon(0.02));
  CHECK(speed_of_lone<3>() == doctest::Approx(-10.0).epsilon(0.02));
}

TEST_CASE("linear shape functions: a block whose sides lie on or just over lines of nodes stays as slow as it began") {
  for (const double courant : {0.25, 0.5})
    for (const double beyond : {0.0, 1e-9, 1e-6, 1e-3, 0.01, 0.03, 0.1, 0.3}) {
      CAPTURE(courant);
      CAPTURE(beyond);
      CHECK(fastest(beyond, courant, -1.0) < 5e-3);
    }
}

TEST_CASE("lighter nodes than courant^2 / 4 of the particles beside them throw these about") {
  CHECK_THROWS(fastest(1e-3, 0.5, 1e-6));
}

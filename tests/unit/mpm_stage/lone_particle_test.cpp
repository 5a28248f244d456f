// What time/courant may be for a particle alone on its nodes (step/lone_particle.hpp).
#include <doctest/doctest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/lone_particle.hpp"
#include "mpm_stage/step/solver.hpp"
#include "mpm_stage/transfer/sparse_patches.hpp"

using namespace tailrun::mpm;

namespace {

// So strong that it stays elastic (strengths of 1e9 Pa below).
Material clay(bool averaged) {
  Material m;
  m.name = "clay";
  m.law = &law_named("tresca");
  m.youngs_modulus = 5e6;
  m.poisson_ratio = 0.49;
  m.average_volumetric_strain = averaged;
  return m;
}

// A lone particle, `place` cells from a node each way, that breathes with 1e-3 1/s.
std::unique_ptr<Solver<2>> lone(double courant, double place, ShapeName shape, bool averaged) {
  constexpr double h = 1.0;
  Particles<2> P;
  P.resize(1, true, false);
  for (int d = 0; d < 2; ++d) {
    P.position[d][0] = 8.0 + place;
    P.affine[d * 3][0] = 1e-3;
  }
  P.volume[0] = 0.25 * h * h;
  P.mass[0] = 1870.0 * P.volume[0];
  P.strength[0] = 1e9;
  SolverOptions o;
  o.courant = courant;
  o.shape = shape;
  static const Terrain none;
  auto s = make_solver<2>(o, h, {}, std::move(P), {clay(averaged)}, none, Walls<2>{});
  s->start(1e30);
  return s;
}

// What its breathing grows to in 400 steps (times).
double growth(double courant, double place, ShapeName shape = ShapeName::quadratic, bool averaged = false) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // for one particle
  const auto s = lone(courant, place, shape, averaged);
  double most = 0.0;
  for (int n = 0; n < 400 && most < 1.0; ++n) {
    s->step({}, {}, 1e30);
    most = std::max(most, std::fabs(s->particles().affine[0][0]));
  }
  omp_set_num_threads(threads);
  return most / 1e-3;
}

// How it breathes after `steps`, times the start.
double breathing(double courant, int steps, bool averaged) {
  const auto s = lone(courant, 0.25, ShapeName::quadratic, averaged);
  for (int n = 0; n < steps; ++n) s->step({}, {}, 1e30);
  return s->particles().affine[0][0] / 1e-3;
}

// Whether the small random motion of a random group of 1 to 12 particles, in a room of 0.2 to 2.5 cells, grows tenfold
// in 300 steps.
bool flies_apart(std::uint32_t group, double courant, bool averaged) {
  std::mt19937 numbers(group);  // the same sequence everywhere; distributions are not
  const auto random = [&numbers] { return static_cast<double>(numbers()) / 4294967296.0; };
  const double wide = 0.2 + 2.3 * random(), high = 0.2 + 2.3 * random();
  const int most = std::clamp(static_cast<int>(4.0 * wide * high), 1, 12);
  const auto count = static_cast<std::size_t>(1 + static_cast<int>(random() * most));
  Particles<2> P;
  P.resize(count, true, false);
  for (std::size_t p = 0; p < count; ++p) {
    P.identity[p] = static_cast<std::int32_t>(p);
    P.volume[p] = 0.25;
    P.mass[p] = 1870.0 * P.volume[p];
    P.strength[p] = 1e9;
    P.position[0][p] = 8.0 + wide * random();
    P.position[1][p] = 8.0 + high * random();
    for (int k = 0; k < 4; ++k) P.affine[k][p] = 1e-4 * (random() - 0.5);
  }
  SolverOptions o;
  o.courant = courant;
  const Terrain none;
  const auto s = make_solver<2>(o, 1.0, {}, std::move(P), {clay(averaged)}, none, Walls<2>{});
  s->start(1e30);
  const auto largest = [&s] {
    double most_of_all = 0.0;
    for (const auto& column : s->particles().affine)
      for (const double c : column) most_of_all = std::max(most_of_all, std::fabs(c));
    return most_of_all;
  };
  const double before = largest();
  for (int n = 0; n < 300; ++n) {
    s->step({}, {}, 1e30);
    if (largest() > 10.0 * before) return true;
  }
  return false;
}

int flying_apart(std::uint32_t groups, double courant, bool averaged) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // for a few particles
  int apart = 0;
  for (std::uint32_t k = 0; k < groups; ++k) apart += flies_apart(k, courant, averaged) ? 1 : 0;
  omp_set_num_threads(threads);
  return apart;
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

TEST_CASE("softened where it is sparse, soil bears courant 0.7 alone, and all but one in hundreds of groups do") {
  for (const double place : {0.0, 0.1, 0.25, 0.4, 0.45, 0.48, 0.5, 0.75}) {
    CAPTURE(place);
    CHECK(growth(SparsePatches::longest_courant, place, ShapeName::quadratic, true) < 2.0);
  }
  // Up to 0.5 nothing is softened.
  for (const int steps : {2, 3, 5, 8})
    CHECK(breathing(0.5, steps, true) == doctest::Approx(breathing(0.5, steps, false)).epsilon(1e-9));
  CHECK(breathing(0.51, 3, true) != doctest::Approx(breathing(0.51, 3, false)).epsilon(0.01));
  constexpr std::uint32_t groups = 200;
  for (const double courant : {0.5, 0.65, SparsePatches::longest_courant, 0.8, 1.0})
    MESSAGE("of " << groups << " groups fly apart at courant " << courant << ": "
                  << flying_apart(groups, courant, false) << ", softened " << flying_apart(groups, courant, true));
  CHECK(flying_apart(groups, 0.65, true) == 0);
  CHECK(flying_apart(groups, SparsePatches::longest_courant, true) <= 1);
  CHECK(flying_apart(groups, SparsePatches::longest_courant, false) > 20);
  CHECK(flying_apart(groups, 0.5, false) == 0);
}

TEST_CASE("what is sparse is so by volume and by spread; a patch filled evenly by three quarters is not") {
  SparsePatches sparse;
  CHECK_FALSE(sparse.active());
  sparse.cell = 4.0;
  CHECK(sparse.share(4.0 * 3.0, 0.62) == doctest::Approx(1.0));
  CHECK(sparse.share(4.0 * 4.0, 0.625) == 1.0);                 // four particles in each cell, regularly
  CHECK(sparse.share(4.0 * 1.0, 0.0) == doctest::Approx(0.3));  // one particle, however large
  CHECK(sparse.share(4.0 * 0.0, 0.5) == doctest::Approx(0.3));
  CHECK(sparse.share(4.0 * 1.5, 0.62) == doctest::Approx(0.65));
}

TEST_CASE("with linear functions and GIMP, too, a lone particle bears the longest step and not a tenth more") {
  for (const ShapeName shape : {ShapeName::linear, ShapeName::gimp}) {
    const double longest = shape == ShapeName::linear ? longest_courant<LinearShape>(2) : longest_courant<GimpShape>(2);
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

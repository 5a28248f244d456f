// Four particles at a time against one at a time, and the two forms of a node's sums against each other.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/transfer/particles_to_grid.hpp"

using namespace tailrun::mpm;

TEST_CASE_TEMPLATE("a line's sums and what it spreads are those of the weights, slopes and moments", Shape, LinearShape,
                   QuadraticShape, CubicShape, GimpShape) {
  using At = ShapeAt<Shape>;
  constexpr int S = Shape::support;
  const Vec4 X = {2.03, 3.49, 4.51, 5.97}, c = {1.0, -2.0, 0.5, 3.0}, s = {0.7, 1.1, -1.3, 2.0};
  const At at(X);
  Vec4 u[S], slopes[S], moments[S], both[S];
  for (int k = 0; k < S; ++k) u[k] = Vec4{1.0 + k, 2.0 - k * k, std::cos(k), 0.3 * k};
  const LineSums sums = at.sums(u);
  at.spread_slope(s, slopes);
  at.spread_moment(c, moments);
  at.spread_both(s, c, both);
  for (int lane = 0; lane < 4; ++lane) {
    double w[S], d[S], m[S], value = 0.0, slope = 0.0, moment = 0.0;
    CHECK(at.base[lane] == Shape::evaluate(X[lane], w, d, m));
    for (int k = 0; k < S; ++k) {
      value += w[k] * u[k][lane];
      slope += d[k] * u[k][lane];
      moment += m[k] * u[k][lane];
      CHECK(std::fabs(at.w[k][lane] - w[k]) < 1e-14);
      CHECK(std::fabs(At::slope_unit * slopes[k][lane] - s[lane] * d[k]) < 1e-14);
      CHECK(std::fabs(At::moment_unit * moments[k][lane] - c[lane] * m[k]) < 1e-14);
      CHECK(std::fabs(both[k][lane] - slopes[k][lane] - moments[k][lane]) < 1e-14);
    }
    CHECK(std::fabs(sums.value[lane] - value) < 1e-14);
    CHECK(std::fabs(At::slope_unit * sums.slope[lane] - slope) < 1e-14);
    CHECK(std::fabs(At::moment_unit * sums.moment[lane] - moment) < 1e-14);
  }
}

TEST_CASE_TEMPLATE("momentum and forces apart make the same nodes as their sum", Shape, LinearShape, QuadraticShape,
                   CubicShape, GimpShape) {
  constexpr int nodes = Tile<2, Shape>::nodes;
  constexpr double dt = 0.01, h = 0.5;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Particles<2> P;
  P.resize(67, true, false);  // a group that is not full at the end
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (int d = 0; d < 2; ++d) {
      P.position[d][p] = h * (2.0 + 7.5 * unit(random));
      P.velocity[d][p] = unit(random) - 0.5;
    }
    for (auto& column : P.affine) column[p] = unit(random) - 0.5;
    for (auto& column : P.stress) column[p] = unit(random) - 0.5;
    P.mass[p] = 1.0 + unit(random);
    P.volume[p] = unit(random);
  }
  AlignedVector<Vec4> together(nodes, Vec4{}), apart(nodes, Vec4{});
  AlignedVector<double> mass(nodes, 0.0);
  particles_to_grid<Shape, false, false>(dt, 1.0 / h, {0.0, 0.0}, P, 0, P.count(), together.data(), nullptr);
  particles_to_grid<Shape, true, false>(dt, 1.0 / h, {0.0, 0.0}, P, 0, P.count(), apart.data(), mass.data());
  double total = 0.0, wanted = 0.0, most = 0.0;
  for (const double m : P.mass) wanted += m;
  for (int n = 0; n < nodes; ++n) {
    total += mass[n];
    most = std::max(most, std::fabs(mass[n] - together[n][0]));
    for (int d = 0; d < 2; ++d)
      most = std::max(most, std::fabs(apart[n][d] + dt * apart[n][2 + d] - together[n][1 + d]));
  }
  CHECK(total == doctest::Approx(wanted).epsilon(1e-13));
  CHECK(most < 1e-13);
}

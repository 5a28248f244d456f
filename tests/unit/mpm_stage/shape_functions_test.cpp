#include "mpm_stage/grid/shape_functions.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace tailrun::mpm;

// Sums over a shape's nodes at X: weights, derivatives, first moment from the weights and as given, about the place
// that the shape takes a particle at X to be at.
template <class Shape>
void check_completeness(double (*place)(double) = [](double X) { return X; }) {
  for (double X = 3.0; X < 5.0; X += 0.0137) {
    double w[4], d[4], m[4], sum = 0, slope = 0, position = 0, gradient = 0, moment = 0;
    const int base = Shape::evaluate(X, w, d, m);
    for (int k = 0; k < Shape::support; ++k) {
      sum += w[k];
      slope += d[k];
      position += w[k] * (base + k);
      gradient += d[k] * (base + k);
      moment += m[k];
      CHECK(m[k] == doctest::Approx(w[k] * (base + k - place(X))).epsilon(1e-12));
      CHECK(w[k] >= 0.0);
    }
    CHECK(sum == doctest::Approx(1.0).epsilon(1e-13));
    CHECK(std::fabs(slope) < 1e-13);
    CHECK(position == doctest::Approx(place(X)).epsilon(1e-13));
    CHECK(gradient == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(std::fabs(moment) < 1e-13);
  }
}

TEST_CASE("shape functions reproduce constants and linear fields") {
  SUBCASE("linear") {
    check_completeness<LinearShape>([](double X) {
      return std::floor(X) + std::clamp(X - std::floor(X), LinearShape::nearest, 1.0 - LinearShape::nearest);
    });
  }
  SUBCASE("quadratic") {
    check_completeness<QuadraticShape>();
  }
  SUBCASE("cubic") {
    check_completeness<CubicShape>();
  }
  SUBCASE("gimp") {
    check_completeness<GimpShape>();
  }
}

// Jiang et al. (2015): sum w (x_i - x)^2 is h^2/4 for quadratic and h^2/3 for cubic B-splines, wherever x is.
template <class Shape>
void check_second_moment() {
  for (double X = 3.0; X < 4.0; X += 0.019) {
    double w[4], d[4], m[4], second = 0;
    const int base = Shape::evaluate(X, w, d, m);
    for (int k = 0; k < Shape::support; ++k) second += w[k] * (base + k - X) * (base + k - X);
    CHECK(second * Shape::apic == doctest::Approx(1.0).epsilon(1e-12));
  }
}

TEST_CASE("inertia of the affine velocity is a constant for B-splines") {
  check_second_moment<QuadraticShape>();
  check_second_moment<CubicShape>();
}

TEST_CASE("B-spline derivatives are those of the weights") {
  for (double X = 3.03; X < 4.0; X += 0.05) {
    const double e = 1e-6;
    double wa[3], wb[3], w[3], d[3], u[3], m[3];
    const int a = QuadraticShape::evaluate(X - e, wa, u, m), b = QuadraticShape::evaluate(X + e, wb, u, m);
    const int c = QuadraticShape::evaluate(X, w, d, m);
    if (a != b || a != c) continue;
    for (int k = 0; k < 3; ++k) CHECK(d[k] == doctest::Approx((wb[k] - wa[k]) / (2 * e)).epsilon(1e-7));
  }
}

template <class Shape>
void check_stiffness() {
  double largest = 0.0;
  for (double X = 3.0; X < 4.0; X += 1e-4 * (1.0 + 1e-5)) {
    double w[4], d[4], m[4], stiffness = 0.0;
    Shape::evaluate(X, w, d, m);
    for (int k = 0; k < Shape::support; ++k)
      if (w[k] > 0.0) stiffness += d[k] * d[k] / w[k];
    largest = std::max(largest, stiffness);
  }
  CHECK(largest <= Shape::largest_stiffness * (1.0 + 1e-9));
  CHECK(largest > 0.999 * Shape::largest_stiffness);
}

TEST_CASE("no place in a cell is stiffer for a lone particle than a shape says") {
  check_stiffness<LinearShape>();
  check_stiffness<QuadraticShape>();
  check_stiffness<GimpShape>();
}

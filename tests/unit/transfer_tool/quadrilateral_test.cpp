#include "transfer_tool/sample/quadrilateral.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun::transfer;

namespace {
const Corners distorted = {{{0.1, -0.2}, {2.3, 0.1}, {2.0, 1.4}, {-0.3, 1.1}}};
}

TEST_CASE("Gauss-Legendre rules integrate monomials up to degree 2 n - 1") {
  for (int points = 1; points <= 5; ++points)
    for (int degree = 0; degree < 2 * points; ++degree) {
      const GaussRule& rule = gauss_rule(points);
      double integral = 0.0;
      for (std::size_t i = 0; i < rule.weight.size(); ++i)
        integral += rule.weight[i] * std::pow(rule.abscissa[i], degree);
      CAPTURE(points);
      CAPTURE(degree);
      CHECK(integral == doctest::Approx(degree % 2 ? 0.0 : 2.0 / (degree + 1)).epsilon(1e-14));
    }
}

TEST_CASE("Gauss-Legendre rules are not exact beyond their degree") {
  const GaussRule& rule = gauss_rule(3);
  double integral = 0.0;
  for (std::size_t i = 0; i < 3; ++i) integral += rule.weight[i] * std::pow(rule.abscissa[i], 6);
  CHECK(std::abs(integral - 2.0 / 7.0) > 1e-3);
}

TEST_CASE("closed-form integrals of shape functions equal a 5 x 5 rule") {
  const GaussRule& rule = gauss_rule(5);
  NodeWeights expected{};
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 5; ++j)
      for (std::size_t a = 0; a < 4; ++a)
        expected[a] += rule.weight[i] * rule.weight[j] * jacobian(distorted, rule.abscissa[i], rule.abscissa[j]) *
                       shape_functions(rule.abscissa[i], rule.abscissa[j])[a];
  const NodeWeights found = integrated_shape_functions(distorted);
  for (std::size_t a = 0; a < 4; ++a) CHECK(found[a] == doctest::Approx(expected[a]).epsilon(1e-14));
  CHECK(found[0] + found[1] + found[2] + found[3] == doctest::Approx(area(distorted)).epsilon(1e-14));
}

TEST_CASE("scaled Jacobian: rectangle 1, parallelogram the sine of its angle, folded element negative") {
  CHECK(scaled_jacobian({{{0, 0}, {3, 0}, {3, 1}, {0, 1}}}) == doctest::Approx(1.0));
  CHECK(scaled_jacobian({{{0, 0}, {2, 0}, {3, std::sqrt(3.0)}, {1, std::sqrt(3.0)}}}) ==
        doctest::Approx(std::sqrt(3.0) / 2.0));
  CHECK(scaled_jacobian({{{0, 0}, {2, 0}, {0.2, 0.2}, {0, 2}}}) < 0.0);
  CHECK(area({{{0, 0}, {0, 1}, {1, 1}, {1, 0}}}) == doctest::Approx(-1.0));
}

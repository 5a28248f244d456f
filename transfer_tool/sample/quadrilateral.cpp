#include "transfer_tool/sample/quadrilateral.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tailrun::transfer {
namespace {

constexpr std::array<double, 4> node_xi = {-1.0, 1.0, 1.0, -1.0};
constexpr std::array<double, 4> node_eta = {-1.0, -1.0, 1.0, 1.0};

double cross(const std::array<double, 2>& from, const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return (a[0] - from[0]) * (b[1] - from[1]) - (a[1] - from[1]) * (b[0] - from[0]);
}

}  // namespace

NodeWeights shape_functions(double xi, double eta) {
  NodeWeights values;
  for (std::size_t a = 0; a < 4; ++a) values[a] = 0.25 * (1.0 + node_xi[a] * xi) * (1.0 + node_eta[a] * eta);
  return values;
}

double jacobian(const Corners& corners, double xi, double eta) {
  double x_xi = 0.0, x_eta = 0.0, y_xi = 0.0, y_eta = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    const double along_xi = 0.25 * node_xi[a] * (1.0 + node_eta[a] * eta);
    const double along_eta = 0.25 * node_eta[a] * (1.0 + node_xi[a] * xi);
    x_xi += along_xi * corners[a][0];
    y_xi += along_xi * corners[a][1];
    x_eta += along_eta * corners[a][0];
    y_eta += along_eta * corners[a][1];
  }
  return x_xi * y_eta - x_eta * y_xi;
}

std::array<double, 2> centre(const Corners& corners) {
  std::array<double, 2> sum{};
  for (const auto& corner : corners)
    for (std::size_t i = 0; i < 2; ++i) sum[i] += 0.25 * corner[i];
  return sum;
}

double area(const Corners& corners) {
  return 0.5 * ((corners[2][0] - corners[0][0]) * (corners[3][1] - corners[1][1]) -
                (corners[2][1] - corners[0][1]) * (corners[3][0] - corners[1][0]));
}

double scaled_jacobian(const Corners& corners) {
  double smallest = 1.0;
  for (std::size_t a = 0; a < 4; ++a) {
    const auto& here = corners[a];
    const auto& next = corners[(a + 1) % 4];
    const auto& previous = corners[(a + 3) % 4];
    const double edges =
        std::hypot(next[0] - here[0], next[1] - here[1]) * std::hypot(previous[0] - here[0], previous[1] - here[1]);
    smallest = std::min(smallest, edges > 0.0 ? cross(here, next, previous) / edges : 0.0);
  }
  return smallest;
}

const GaussRule& gauss_rule(int points) {
  static const std::array<GaussRule, 5> rules = [] {
    std::array<GaussRule, 5> made;
    made[0] = {{0.0}, {2.0}};
    const double two = 1.0 / std::sqrt(3.0);
    made[1] = {{-two, two}, {1.0, 1.0}};
    const double three = std::sqrt(0.6);
    made[2] = {{-three, 0.0, three}, {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0}};
    const double inner4 = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(1.2));
    const double outer4 = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(1.2));
    const double inner4_weight = (18.0 + std::sqrt(30.0)) / 36.0, outer4_weight = (18.0 - std::sqrt(30.0)) / 36.0;
    made[3] = {{-outer4, -inner4, inner4, outer4}, {outer4_weight, inner4_weight, inner4_weight, outer4_weight}};
    const double inner5 = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double outer5 = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double inner5_weight = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
    const double outer5_weight = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
    made[4] = {{-outer5, -inner5, 0.0, inner5, outer5},
               {outer5_weight, inner5_weight, 128.0 / 225.0, inner5_weight, outer5_weight}};
    return made;
  }();
  if (points < 1 || points > 5) throw std::logic_error("gauss_rule: 1 to 5 points");
  return rules[static_cast<std::size_t>(points - 1)];
}

NodeWeights integrated_shape_functions(const Corners& corners) {
  NodeWeights corner_jacobian;
  for (std::size_t b = 0; b < 4; ++b) corner_jacobian[b] = jacobian(corners, node_xi[b], node_eta[b]);
  NodeWeights integral{};
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b) {
      const std::size_t apart = (b + 4 - a) % 4;
      integral[a] += (apart == 0 ? 4.0 : apart == 2 ? 1.0 : 2.0) / 9.0 * corner_jacobian[b];
    }
  return integral;
}

}  // namespace tailrun::transfer

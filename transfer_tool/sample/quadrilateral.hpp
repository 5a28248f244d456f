// The four-node isoparametric quadrilateral: shape functions, Jacobian and Gauss-Legendre rules on [-1, 1]^2.
// Nodes are counter-clockwise from (-1, -1). Hughes, The Finite Element Method (1987), section 3.2.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace tailrun::transfer {

using Corners = std::array<std::array<double, 2>, 4>;  // m, (x, y) of the four nodes
using NodeWeights = std::array<double, 4>;             // one number per node of an element

// N_a(xi, eta) = (1 + xi_a xi)(1 + eta_a eta)/4.
NodeWeights shape_functions(double xi, double eta);

// det(d(x, y)/d(xi, eta)), m2. It is a bilinear function of (xi, eta), so its value anywhere is the shape functions'
// interpolation of its values at the nodes.
double jacobian(const Corners& corners, double xi, double eta);

// Mean of the four corners, m.
std::array<double, 2> centre(const Corners& corners);

// Exact area, m2: (diagonal x diagonal)/2; negative when the nodes run clockwise.
double area(const Corners& corners);

// Smallest over the nodes of the Jacobian divided by the product of the two edges that meet there; 1 for a rectangle,
// 0 or less for an element that is folded (Knupp 2003).
double scaled_jacobian(const Corners& corners);

// Abscissae and weights on [-1, 1], exact for polynomials of degree 2 points - 1. `points` 1 to 5.
struct GaussRule {
  std::vector<double> abscissa, weight;
};
const GaussRule& gauss_rule(int points);

// Integral over the element of N_a times the Jacobian, m2, in closed form: with the Jacobian's nodal values J_b the
// integral is sum_b M_ab J_b, where M is 4/9 on the diagonal, 2/9 for neighbours and 1/9 for opposite nodes.
NodeWeights integrated_shape_functions(const Corners& corners);

template <typename Array>
double interpolate(const NodeWeights& weights, const Array& nodal) {
  return weights[0] * nodal[0] + weights[1] * nodal[1] + weights[2] * nodal[2] + weights[3] * nodal[3];
}

}  // namespace tailrun::transfer

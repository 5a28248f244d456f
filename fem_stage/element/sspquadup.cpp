#include "fem_stage/element/sspquadup.hpp"

#include <algorithm>
#include <cmath>

namespace tailrun::fem {
namespace {

constexpr double xi_sign[4] = {-1, 1, 1, -1}, eta_sign[4] = {-1, -1, 1, 1}, hourglass_sign[4] = {1, -1, 1, -1};

struct Jacobian {
  double xx, xy, yx, yy;  // dx/dxi, dx/deta, dy/dxi, dy/deta
  double determinant() const { return xx * yy - xy * yx; }
};

Jacobian jacobian_at(const double x[4], const double y[4], double xi, double eta) {
  Jacobian j{};
  for (int a = 0; a < 4; ++a) {
    const double by_xi = 0.25 * xi_sign[a] * (1.0 + eta_sign[a] * eta),
                 by_eta = 0.25 * eta_sign[a] * (1.0 + xi_sign[a] * xi);
    j.xx += by_xi * x[a];
    j.xy += by_eta * x[a];
    j.yx += by_xi * y[a];
    j.yy += by_eta * y[a];
  }
  return j;
}

// Adds one integration point's share of the pressure matrices.
void add_pressure_point(const double x[4], const double y[4], double xi, double eta, double weight, double* mass,
                        double* gxx, double* gyy, double* gx, double* gy) {
  const Jacobian j = jacobian_at(x, y, xi, eta);
  const double det = j.determinant(), w = weight * det;
  double n[4], nx[4], ny[4];
  for (int a = 0; a < 4; ++a) {
    n[a] = 0.25 * (1.0 + xi_sign[a] * xi) * (1.0 + eta_sign[a] * eta);
    const double by_xi = 0.25 * xi_sign[a] * (1.0 + eta_sign[a] * eta),
                 by_eta = 0.25 * eta_sign[a] * (1.0 + xi_sign[a] * xi);
    nx[a] = (by_xi * j.yy - by_eta * j.yx) / det;
    ny[a] = (-by_xi * j.xy + by_eta * j.xx) / det;
  }
  for (int a = 0; a < 4; ++a) {
    gx[a] += w * nx[a];
    gy[a] += w * ny[a];
    for (int b = 0; b <= a; ++b) {
      mass[lower(a, b)] += w * n[a] * n[b];
      gxx[lower(a, b)] += w * nx[a] * nx[b];
      gyy[lower(a, b)] += w * ny[a] * ny[b];
    }
  }
}

// F per unit of G: integrals of (4/3) t J0 kind, section 3 of the formulation (McGann et al. 2012, eq. 42 ff.).
std::array<double, 3> hourglass_matrix(const Jacobian& j, double thickness, HourglassShape shape) {
  const double det = j.determinant(), scale = 4.0 / 3.0 * thickness * det;
  const double xi_x = j.yy / det, xi_y = -j.xy / det, eta_x = -j.yx / det, eta_y = j.xx / det;
  if (shape == HourglassShape::constant_jacobian)
    return {scale * (xi_x * xi_x + eta_x * eta_x), -scale * (xi_x * xi_y + eta_x * eta_y),
            scale * (xi_y * xi_y + eta_y * eta_y)};
  const double l1 = std::hypot(j.xx, j.yx), l2 = std::hypot(j.xy, j.yy);
  const double g1x = j.xx / l1, g1y = j.yx / l1, g2x = j.xy / l2, g2y = j.yy / l2;
  const double ixx = scale * (g1x * g1x + g2x * g2x), ixy = scale * (g1x * g1y + g2x * g2y),
               iyy = scale * (g1y * g1y + g2y * g2y);
  const double hxx = ixx * eta_x * eta_x + ixy * xi_x * eta_x + iyy * xi_x * xi_x;
  const double hyy = ixx * eta_y * eta_y + ixy * xi_y * eta_y + iyy * xi_y * xi_y;
  const double hxy = ixx * eta_x * eta_y + ixy * (eta_x * xi_y + eta_y * xi_x) + iyy * xi_x * xi_y;
  return {hxx, -hxy, hyy};
}

}  // namespace

SspQuadUp build_sspquadup(const Mesh& mesh, std::span<const double> displacement, std::span<const double> thickness,
                          HourglassShape shape, int pressure_points) {
  const std::size_t count = mesh.elements();
  SspQuadUp out;
  for (auto* array : {&out.dndx, &out.dndy, &out.gamma, &out.nodal_volume, &out.gradient_x, &out.gradient_y})
    array->assign(4 * count, 0.0);
  for (auto* array : {&out.mass_matrix, &out.gradient_xx, &out.gradient_yy}) array->assign(10 * count, 0.0);
  out.hourglass.assign(3 * count, 0.0);
  out.volume.assign(count, 0.0);
  out.size.assign(count, 0.0);
#pragma omp parallel for schedule(static)
  for (std::size_t e = 0; e < count; ++e) {
    double x[4], y[4];
    for (int a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(mesh.quads[4 * e + a]);
      x[a] = mesh.x(node) + (displacement.empty() ? 0.0 : displacement[2 * node]);
      y[a] = mesh.y(node) + (displacement.empty() ? 0.0 : displacement[2 * node + 1]);
    }
    const double t = thickness[e];
    const Jacobian j = jacobian_at(x, y, 0.0, 0.0);
    const double j0 = j.determinant();
    out.volume[e] = 4.0 * j0 * t;
    double hx = 0.0, hy = 0.0;
    for (int a = 0; a < 4; ++a) {
      out.dndx[4 * e + a] = 0.25 * (xi_sign[a] * j.yy - eta_sign[a] * j.yx) / j0;
      out.dndy[4 * e + a] = 0.25 * (-xi_sign[a] * j.xy + eta_sign[a] * j.xx) / j0;
      hx += hourglass_sign[a] * x[a];
      hy += hourglass_sign[a] * y[a];
    }
    // J(xi, eta) = J0 + j1 xi + j2 eta gives the exact integral of N_a
    const double j1 = 0.125 * ((x[1] - x[0]) * (y[2] - y[3]) + (x[2] - x[3]) * (y[0] - y[1]));
    const double j2 = 0.125 * ((x[0] - x[3]) * (y[2] - y[1]) + (x[2] - x[1]) * (y[3] - y[0]));
    for (int a = 0; a < 4; ++a) {
      out.gamma[4 * e + a] = 0.25 * (hourglass_sign[a] - hx * out.dndx[4 * e + a] - hy * out.dndy[4 * e + a]);
      out.nodal_volume[4 * e + a] = t * (j0 + j1 * xi_sign[a] / 3.0 + j2 * eta_sign[a] / 3.0);
    }
    const auto f = hourglass_matrix(j, t, shape);
    std::copy(f.begin(), f.end(), &out.hourglass[3 * e]);
    const double along = 0.5 * std::hypot(x[1] + x[2] - x[0] - x[3], y[1] + y[2] - y[0] - y[3]);
    const double across = 0.5 * std::hypot(x[2] + x[3] - x[0] - x[1], y[2] + y[3] - y[0] - y[1]);
    out.size[e] = std::min(along, across);

    double *mass = &out.mass_matrix[10 * e], *gxx = &out.gradient_xx[10 * e], *gyy = &out.gradient_yy[10 * e];
    double *gx = &out.gradient_x[4 * e], *gy = &out.gradient_y[4 * e];
    if (pressure_points == 1) {
      add_pressure_point(x, y, 0.0, 0.0, 4.0 * t, mass, gxx, gyy, gx, gy);
    } else {
      const double gauss = 1.0 / std::sqrt(3.0);
      for (const double xi : {-gauss, gauss})
        for (const double eta : {-gauss, gauss}) add_pressure_point(x, y, xi, eta, t, mass, gxx, gyy, gx, gy);
    }
  }
  return out;
}

void sspquadup_stiffness(const SspQuadUp& elements, std::size_t e, double bulk, double shear, double shear_hourglass,
                         double stiffness[64]) {
  const double c11 = bulk + 4.0 / 3.0 * shear, c12 = bulk - 2.0 / 3.0 * shear, volume = elements.volume[e];
  const double *nx = &elements.dndx[4 * e], *ny = &elements.dndy[4 * e], *gamma = &elements.gamma[4 * e];
  const double f11 = shear_hourglass * elements.hourglass[3 * e], f12 = shear_hourglass * elements.hourglass[3 * e + 1],
               f22 = shear_hourglass * elements.hourglass[3 * e + 2];
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const double g = gamma[a] * gamma[b];
      stiffness[8 * (2 * a) + 2 * b] = volume * (c11 * nx[a] * nx[b] + shear * ny[a] * ny[b]) + f11 * g;
      stiffness[8 * (2 * a) + 2 * b + 1] = volume * (c12 * nx[a] * ny[b] + shear * ny[a] * nx[b]) + f12 * g;
      stiffness[8 * (2 * a + 1) + 2 * b] = volume * (c12 * ny[a] * nx[b] + shear * nx[a] * ny[b]) + f12 * g;
      stiffness[8 * (2 * a + 1) + 2 * b + 1] = volume * (c11 * ny[a] * ny[b] + shear * nx[a] * nx[b]) + f22 * g;
    }
  }
}

}  // namespace tailrun::fem

// SSPquadUP: stabilised single-point quadrilateral with displacement and pore pressure at its four nodes (McGann,
// Arduino & Mackenzie-Helnwein 2012, Acta Geotechnica 7:297-311). Small strain; stress tension positive, pore pressure
// compression positive. All elements of a mesh as a structure of arrays: everything that depends on geometry alone.
//
//   strain at the point   eps = B u,  B from the constant centre derivatives dN/dx, dN/dy
//   hourglass amplitudes  q = (gamma . u_x, gamma . u_y), force G F q with F below
//   coupling              Q_(a,i),b = V/4 dN_a/dx_i    (so Q p = V dN_a/dx_i p_mean)
#pragma once

#include <array>
#include <span>
#include <vector>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

enum class HourglassShape {
  constant_jacobian,  // (4/3) t J0 (xi,i xi,j + eta,i eta,j)
  opensees,           // with the unit columns of the Jacobian, as OpenSees 3.x does; differs for skewed elements
};

struct SspQuadUp {
  std::vector<double> dndx, dndy;    // 1/m, (M, 4)
  std::vector<double> gamma;         // 1, (M, 4): hourglass vector
  std::vector<double> hourglass;     // m, (M, 3): F11, F12, F22 per unit of shear modulus
  std::vector<double> volume;        // m3, (M): 4 J0 t
  std::vector<double> nodal_volume;  // m3, (M, 4): integral of N_a
  std::vector<double> size;          // m, (M): the shorter of the two lines joining mid-sides
  std::vector<double> mass_matrix;   // m3, (M, 10): lower triangle of integral N_a N_b, row by row
  std::vector<double> gradient_xx;   // m, (M, 10): lower triangle of integral dN_a/dx dN_b/dx
  std::vector<double> gradient_yy;   // m, (M, 10): lower triangle of integral dN_a/dy dN_b/dy
  std::vector<double> gradient_x;    // m2, (M, 4): integral of dN_a/dx (gravity driven seepage)
  std::vector<double> gradient_y;    // m2, (M, 4)

  std::size_t count() const { return volume.size(); }
};

// `displacement` (m, (N, 2)) moves the mesh (empty: undeformed); `thickness` m, (M). `pressure_points` 1 integrates the
// pressure matrices at the centre (OpenSees; has a checkerboard null space), 2 with 2 x 2 Gauss points.
SspQuadUp build_sspquadup(const Mesh& mesh, std::span<const double> displacement, std::span<const double> thickness,
                          HourglassShape shape, int pressure_points);

// What the element's one point sees of a nodal vector field: its gradient's symmetric part (xy doubled) and the
// hourglass modes. `field` is (N, 2); a displacement gives strains, a velocity their rates.
struct CentreGradient {
  double xx = 0.0, yy = 0.0, xy = 0.0;
  double hourglass_x = 0.0, hourglass_y = 0.0;
};
inline CentreGradient centre_gradient(const SspQuadUp& elements, const std::int64_t* quads,
                                      std::span<const double> field, std::size_t e) {
  CentreGradient out;
  for (std::size_t i = 4 * e; i < 4 * e + 4; ++i) {
    const auto node = static_cast<std::size_t>(quads[i]);
    const double x = field[2 * node], y = field[2 * node + 1], nx = elements.dndx[i], ny = elements.dndy[i];
    out.xx += nx * x;
    out.yy += ny * y;
    out.xy += ny * x + nx * y;
    out.hourglass_x += elements.gamma[i] * x;
    out.hourglass_y += elements.gamma[i] * y;
  }
  return out;
}

// du_y/dx - du_x/dy at the element's point.
inline double vorticity(const SspQuadUp& elements, const std::int64_t* quads, std::span<const double> field,
                        std::size_t e) {
  double out = 0.0;
  for (std::size_t i = 4 * e; i < 4 * e + 4; ++i) {
    const auto node = static_cast<std::size_t>(quads[i]);
    out += elements.dndx[i] * field[2 * node + 1] - elements.dndy[i] * field[2 * node];
  }
  return out;
}

// Index of (a, b) in a lower triangle stored row by row.
constexpr int lower(int a, int b) {
  return a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
}

// Elastic stiffness (N/m), 8 x 8 row-major, freedoms (u_x, u_y) node by node: V B^T C B + shear_hourglass F.
// C isotropic with bulk and shear modulus (Pa).
void sspquadup_stiffness(const SspQuadUp& elements, std::size_t e, double bulk, double shear, double shear_hourglass,
                         double stiffness[64]);

}  // namespace tailrun::fem

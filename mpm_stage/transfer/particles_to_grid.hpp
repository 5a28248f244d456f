// P2G: particles add mass, momentum and internal forces to the nodes of their block's tile.
//
// A node is one value of four lanes: (m, px, py, 0) in 2-D, (m, px, py, pz) in 3-D. What particle p gives to node (i,
// j) separates into w_x(i) A_j + w_y(j) E_i with vectors A_j, E_i made once per particle.
#pragma once

#include <array>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// Without Split, `momentum` gets the momentum after the step's internal forces, m v + dt f, and `force` is not touched;
// with Split momentum before forces and the forces (0, fx, fy, fz), N, apart (FLIP and local damping need both).
// `corner` (m) is node 0 of the tile. HasPore: stress minus pore pressure acts.
template <class Shape, bool Split, bool HasPore>
void particles_to_grid(double dt, double h1, const std::array<double, 2>& corner, const Particles<2>& P,
                       std::size_t begin, std::size_t end, Vec4* __restrict momentum, Vec4* __restrict force) {
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  const double h = 1.0 / h1;
  const bool affine = !P.affine[0].empty();
  for (std::size_t p = begin; p < end; ++p) {
    double wx[S], dx[S], mx[S], wy[S], dy[S], my[S];
    const int i0 = Shape::evaluate((P.position[0][p] - corner[0]) * h1, wx, dx, mx);
    const int j0 = Shape::evaluate((P.position[1][p] - corner[1]) * h1, wy, dy, my);
    const double m = P.mass[p], mh = m * h, u = HasPore ? P.pore_pressure[p] : 0.0;
    const double vol = (Split ? 1.0 : dt) * h1 * P.volume[p];
    const Vec4 base = {m, m * P.velocity[0][p], m * P.velocity[1][p], 0.0};
    Vec4 Cx = {}, Cy = {};
    if (affine) {
      Cx = Vec4{0.0, mh * P.affine[0][p], mh * P.affine[2][p], 0.0};
      Cy = Vec4{0.0, mh * P.affine[1][p], mh * P.affine[3][p], 0.0};
    }
    const double txy = vol * P.stress[3][p];
    const Vec4 Sx = {0.0, vol * (P.stress[0][p] - u), txy, 0.0}, Sy = {0.0, txy, vol * (P.stress[1][p] - u), 0.0};
    Vec4 E[S], F[S];
    for (int i = 0; i < S; ++i) {
      E[i] = Cx * splat(mx[i]);
      if constexpr (Split)
        F[i] = Sx * splat(-dx[i]);
      else
        E[i] -= Sx * splat(dx[i]);
    }
    Vec4* node = momentum + j0 * T + i0;
    Vec4* push = force + (Split ? j0 * T + i0 : 0);
    for (int j = 0; j < S; ++j, node += T) {
      Vec4 A = base * splat(wy[j]) + Cy * splat(my[j]);
      if constexpr (!Split) A -= Sy * splat(dy[j]);
      for (int i = 0; i < S; ++i) node[i] += A * splat(wx[i]) + E[i] * splat(wy[j]);
      if constexpr (Split) {
        const Vec4 Q = Sy * splat(-dy[j]);
        for (int i = 0; i < S; ++i) push[i] += Q * splat(wx[i]) + F[i] * splat(wy[j]);
        push += T;
      }
    }
  }
}

template <class Shape, bool Split, bool HasPore>
void particles_to_grid(double dt, double h1, const std::array<double, 3>& corner, const Particles<3>& P,
                       std::size_t begin, std::size_t end, Vec4* __restrict momentum, Vec4* __restrict force) {
  constexpr int S = Shape::support, T = Tile<3, Shape>::side;
  const double h = 1.0 / h1;
  const bool affine = !P.affine[0].empty();
  for (std::size_t p = begin; p < end; ++p) {
    double w[3][S], d[3][S], q[3][S];
    int base[3];
    for (int a = 0; a < 3; ++a) base[a] = Shape::evaluate((P.position[a][p] - corner[a]) * h1, w[a], d[a], q[a]);
    const double m = P.mass[p], mh = m * h, u = HasPore ? P.pore_pressure[p] : 0.0;
    const double vol = (Split ? 1.0 : dt) * h1 * P.volume[p];
    const Vec4 still = {m, m * P.velocity[0][p], m * P.velocity[1][p], m * P.velocity[2][p]};
    Vec4 C[3] = {}, Sg[3];
    if (affine)
      for (int a = 0; a < 3; ++a)
        C[a] = Vec4{0.0, mh * P.affine[a][p], mh * P.affine[3 + a][p], mh * P.affine[6 + a][p]};
    const double xy = vol * P.stress[3][p], yz = vol * P.stress[4][p], zx = vol * P.stress[5][p];
    Sg[0] = Vec4{0.0, vol * (P.stress[0][p] - u), xy, zx};
    Sg[1] = Vec4{0.0, xy, vol * (P.stress[1][p] - u), yz};
    Sg[2] = Vec4{0.0, zx, yz, vol * (P.stress[2][p] - u)};
    for (int k = 0; k < S; ++k)
      for (int j = 0; j < S; ++j) {
        const std::size_t start = (static_cast<std::size_t>(base[2] + k) * T + base[1] + j) * T + base[0];
        const double wjk = w[1][j] * w[2][k];
        Vec4 A = still * splat(wjk) + C[1] * splat(q[1][j] * w[2][k]) + C[2] * splat(w[1][j] * q[2][k]);
        const Vec4 Q = Sg[1] * splat(-d[1][j] * w[2][k]) + Sg[2] * splat(-w[1][j] * d[2][k]);
        if constexpr (!Split) A += Q;
        for (int i = 0; i < S; ++i) {
          Vec4 E = C[0] * splat(q[0][i]);
          if constexpr (!Split) E -= Sg[0] * splat(d[0][i]);
          momentum[start + i] += A * splat(w[0][i]) + E * splat(wjk);
          if constexpr (Split) force[start + i] += Q * splat(w[0][i]) - Sg[0] * splat(d[0][i] * wjk);
        }
      }
  }
}

}  // namespace tailrun::mpm

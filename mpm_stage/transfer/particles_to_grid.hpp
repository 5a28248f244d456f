// P2G: particles add mass, momentum and internal forces to the nodes of their block's tile.
//
// A node is one value of four lanes: (m, px, py, 0) in 2-D, (m, px, py, pz) in 3-D. What particle p gives to node (i,
// j) separates into w_x(i) A_j + w_y(j) E_i with vectors A_j, E_i made once per particle.
#pragma once

#include <array>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// a, b, c, d as the columns of four rows.
[[gnu::always_inline]] inline void transposed(Vec4 a, Vec4 b, Vec4 c, Vec4 d, Vec4* rows) {
  transpose(a, b, c, d);
  rows[0] = a;
  rows[1] = b;
  rows[2] = c;
  rows[3] = d;
}

// Without Split, `momentum` gets the momentum after the step's internal forces, m v + dt f, and `force` is not touched;
// with Split momentum before forces and the forces (0, fx, fy, fz), N, apart (FLIP and local damping need both).
// `corner` (m) is node 0 of the tile. HasPore: stress minus pore pressure acts.
template <class Shape, bool Split, bool HasPore>
void particles_to_grid(double dt, double h1, const std::array<double, 2>& corner, const Particles<2>& P,
                       std::size_t begin, std::size_t end, Vec4* __restrict momentum, Vec4* __restrict force) {
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  const double h = 1.0 / h1;
  const bool affine = !P.affine[0].empty();
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        // Four particles at a time, until each one's A_j and E_i are known.
        Vec4 wx[S], dx[S], mx[S], wy[S], dy[S], my[S];
        const Int4 i0 = Shape::evaluate((g.read(P.position[0].data()) - corner[0]) * h1, wx, dx, mx);
        const Int4 j0 = Shape::evaluate((g.read(P.position[1].data()) - corner[1]) * h1, wy, dy, my);
        const Vec4 m = g.read(P.mass.data()), vol = ((Split ? 1.0 : dt) * h1) * g.read(P.volume.data());
        const Vec4 px = m * g.read(P.velocity[0].data()), py = m * g.read(P.velocity[1].data());
        Vec4 Cxx = {}, Cxy = {}, Cyx = {}, Cyy = {};
        if (affine) {
          const Vec4 mh = m * h;
          Cxx = mh * g.read(P.affine[0].data());
          Cxy = mh * g.read(P.affine[1].data());
          Cyx = mh * g.read(P.affine[2].data());
          Cyy = mh * g.read(P.affine[3].data());
        }
        Vec4 xx = g.read(P.stress[0].data()), yy = g.read(P.stress[1].data());
        if constexpr (HasPore) {
          const Vec4 u = g.read(P.pore_pressure.data());
          xx -= u;
          yy -= u;
        }
        xx *= vol;
        yy *= vol;
        const Vec4 xy = vol * g.read(P.stress[3].data());
        const Vec4 zero = {};
        Vec4 A[S][4], E[S][4], Q[Split ? S : 1][4], F[Split ? S : 1][4];  // [.][particle]
        for (int j = 0; j < S; ++j) {
          Vec4 ax = px * wy[j] + Cxy * my[j], ay = py * wy[j] + Cyy * my[j];
          Vec4 ex = Cxx * mx[j], ey = Cyx * mx[j];
          if constexpr (Split) {
            transposed(zero, -(xy * dy[j]), -(yy * dy[j]), zero, Q[j]);
            transposed(zero, -(xx * dx[j]), -(xy * dx[j]), zero, F[j]);
          } else {
            ax -= xy * dy[j];
            ay -= yy * dy[j];
            ex -= xx * dx[j];
            ey -= xy * dx[j];
          }
          transposed(m * wy[j], ax, ay, zero, A[j]);
          transposed(zero, ex, ey, zero, E[j]);
        }
        for (int k = 0; k < g.count; ++k) {
          const int at = j0[k] * T + i0[k];
          Vec4 w[S];
          for (int i = 0; i < S; ++i) w[i] = splat(wx[i][k]);
          for (int j = 0; j < S; ++j) {
            Vec4* node = momentum + at + j * T;
            const Vec4 wj = splat(wy[j][k]);
            for (int i = 0; i < S; ++i) node[i] += A[j][k] * w[i] + E[i][k] * wj;
            if constexpr (Split) {
              Vec4* push = force + at + j * T;
              for (int i = 0; i < S; ++i) push[i] += Q[j][k] * w[i] + F[i][k] * wj;
            }
          }
        }
      });
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

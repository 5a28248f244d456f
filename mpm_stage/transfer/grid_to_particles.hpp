// G2P: particles take velocity, affine velocity and displacement gradient from the grid, and move.
//
// One-dimensional sums are nested (x innermost), so each node is read once per particle and used as a vector of all its
// velocity components; in 2-D both halves of a node's four lanes hold the velocity, and one multiply-add forms the
// weighted velocity and its x-derivative together.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// Node velocity as the transfer wants it: (vx, vy, vx, vy) in 2-D, (vx, vy, vz, 0) in 3-D.
template <int Dim>
inline Vec4 node_velocity(const double* v) {
  if constexpr (Dim == 2)
    return Vec4{v[0], v[1], v[0], v[1]};
  else
    return Vec4{v[0], v[1], v[2], 0.0};
}

// Midpoint gradient G = A (I + A/2)^-1 of the increment F = I + A, A = dt grad v: sym(G) is a second-order strain
// increment that vanishes in any rigid rotation, skew(G) the Hughes & Winget (1980) rotation.
[[gnu::always_inline]] inline std::array<double, 4> midpoint_gradient(const std::array<double, 4>& A) {
  const double det = A[0] * A[3] - A[1] * A[2], r = 1.0 / (1.0 + 0.5 * (A[0] + A[3]) + 0.25 * det);
  return {(A[0] + 0.5 * det) * r, A[1] * r, A[2] * r, (A[3] + 0.5 * det) * r};
}

inline std::array<double, 9> midpoint_gradient(const std::array<double, 9>& A) {
  std::array<double, 9> M;
  for (int i = 0; i < 9; ++i) M[i] = 0.5 * A[i] + (i % 4 == 0 ? 1.0 : 0.0);
  std::array<double, 9> c = {M[4] * M[8] - M[5] * M[7], M[2] * M[7] - M[1] * M[8], M[1] * M[5] - M[2] * M[4],
                             M[5] * M[6] - M[3] * M[8], M[0] * M[8] - M[2] * M[6], M[2] * M[3] - M[0] * M[5],
                             M[3] * M[7] - M[4] * M[6], M[1] * M[6] - M[0] * M[7], M[0] * M[4] - M[1] * M[3]};
  const double r = 1.0 / (M[0] * c[0] + M[1] * c[3] + M[2] * c[6]);
  std::array<double, 9> G;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      G[3 * i + j] = (A[3 * i] * c[j] + A[3 * i + 1] * c[3 + j] + A[3 * i + 2] * c[6 + j]) * r;
  return G;
}

// What the velocity of a particle is made of. `flip` is the share of FLIP: v <- flip (v + sum w dv) + (1 - flip) sum w
// v*. With Affine the particle also keeps the grid's affine velocity (Jiang et al. 2015); both together are AFLIP (Fei
// et al. 2021).
struct GridToParticles {
  double dt;            // s
  double inverse_cell;  // 1/m
  double flip = 0.0;
};

// Largest displacement component (m) and speed squared, and kinetic energy (J), of the particles begin .. end.
struct MotionExtremes {
  double displacement = 0.0;
  double speed_squared = 0.0;
  double kinetic = 0.0;
};

// `velocity` (and `change`, the velocity's change over the step, for FLIP) is the tile, `corner` (m) its node 0.
template <class Shape, bool Flip, bool Affine>
MotionExtremes grid_to_particles(const GridToParticles& s, const Vec4* __restrict velocity,
                                 const Vec4* __restrict change, const std::array<double, 2>& corner, Particles<2>& P,
                                 std::size_t begin, std::size_t end) {
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  using Vec2 = double __attribute__((vector_size(16)));
  double* __restrict x = P.position[0].data();
  double* __restrict y = P.position[1].data();
  double* __restrict vx = P.velocity[0].data();
  double* __restrict vy = P.velocity[1].data();
  const double h1 = s.inverse_cell, dt = s.dt, A0 = dt * h1, C0 = Shape::apic * h1;
  double* __restrict gxx = P.gradient[0].data();
  double* __restrict gxy = P.gradient[1].data();
  double* __restrict gyx = P.gradient[2].data();
  double* __restrict gyy = P.gradient[3].data();
  double* __restrict cxx = Affine ? P.affine[0].data() : nullptr;
  double* __restrict cxy = Affine ? P.affine[1].data() : nullptr;
  double* __restrict cyx = Affine ? P.affine[2].data() : nullptr;
  double* __restrict cyy = Affine ? P.affine[3].data() : nullptr;
  double far = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    double wx[S], dx[S], mx[S], wy[S], dy[S], my[S];
    const int i0 = Shape::evaluate((x[p] - corner[0]) * h1, wx, dx, mx);
    const int j0 = Shape::evaluate((y[p] - corner[1]) * h1, wy, dy, my);
    const Vec4* node = velocity + j0 * T + i0;
    Vec4 v_vx = {}, vy_c = {};
    Vec2 cx = {};
    for (int j = 0; j < S; ++j, node += T) {
      Vec4 row = {};
      Vec2 moment = {};
      for (int i = 0; i < S; ++i) {
        row += node[i] * Vec4{wx[i], wx[i], dx[i], dx[i]};
        if constexpr (Affine && Shape::apic > 0.0) moment += Vec2{node[i][0], node[i][1]} * Vec2{mx[i], mx[i]};
      }
      v_vx += row * splat(wy[j]);
      vy_c += __builtin_shuffle(row, row, (__attribute__((vector_size(32))) long){0, 1, 0, 1}) *
              Vec4{dy[j], dy[j], my[j], my[j]};
      if constexpr (Affine && Shape::apic > 0.0) cx += moment * Vec2{wy[j], wy[j]};
    }
    gxx[p] = A0 * v_vx[2];
    gxy[p] = A0 * vy_c[0];
    gyx[p] = A0 * v_vx[3];
    gyy[p] = A0 * vy_c[1];
    if constexpr (Flip) {
      Vec4 dv = {};
      const Vec4* c = change + j0 * T + i0;
      for (int j = 0; j < S; ++j, c += T)
        for (int i = 0; i < S; ++i) dv += c[i] * splat(wx[i] * wy[j]);
      vx[p] = s.flip * (vx[p] + dv[0]) + (1.0 - s.flip) * v_vx[0];
      vy[p] = s.flip * (vy[p] + dv[1]) + (1.0 - s.flip) * v_vx[1];
    } else {
      vx[p] = v_vx[0];
      vy[p] = v_vx[1];
    }
    if constexpr (Affine) {
      if constexpr (Shape::apic > 0.0) {
        cxx[p] = C0 * cx[0];
        cxy[p] = C0 * vy_c[2];
        cyx[p] = C0 * cx[1];
        cyy[p] = C0 * vy_c[3];
      } else {
        cxx[p] = h1 * v_vx[2];
        cxy[p] = h1 * vy_c[0];
        cyx[p] = h1 * v_vx[3];
        cyy[p] = h1 * vy_c[1];
      }
    }
    if constexpr (Flip) {
      const double ux = dt * v_vx[0], uy = dt * v_vx[1];
      x[p] += ux;
      y[p] += uy;
      far = std::max(far, std::max(std::fabs(ux), std::fabs(uy)));
    }
  }
  // What is the same for every particle, as vector code: motion, midpoint gradient and the extremes.
  double fast = 0.0, kinetic = 0.0;
  const double* __restrict mass = P.mass.data();
#pragma omp simd reduction(max : far, fast) reduction(+ : kinetic)
  for (std::size_t p = begin; p < end; ++p) {
    const double ux = dt * vx[p], uy = dt * vy[p];
    if constexpr (!Flip) {
      x[p] += ux;
      y[p] += uy;
      far = std::max(far, std::max(std::fabs(ux), std::fabs(uy)));
    }
    const auto G = midpoint_gradient(std::array<double, 4>{gxx[p], gxy[p], gyx[p], gyy[p]});
    gxx[p] = G[0];
    gxy[p] = G[1];
    gyx[p] = G[2];
    gyy[p] = G[3];
    const double speed = vx[p] * vx[p] + vy[p] * vy[p];
    fast = std::max(fast, speed);
    kinetic += 0.5 * mass[p] * speed;
  }
  return {far, fast, kinetic};
}

template <class Shape, bool Flip, bool Affine>
MotionExtremes grid_to_particles(const GridToParticles& s, const Vec4* __restrict velocity,
                                 const Vec4* __restrict change, const std::array<double, 3>& corner, Particles<3>& P,
                                 std::size_t begin, std::size_t end) {
  constexpr int S = Shape::support, T = Tile<3, Shape>::side;
  const double h1 = s.inverse_cell, dt = s.dt;
  double far = 0.0, fast = 0.0, kinetic = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    double w[3][S], d[3][S], m[3][S];
    int base[3];
    for (int a = 0; a < 3; ++a) base[a] = Shape::evaluate((P.position[a][p] - corner[a]) * h1, w[a], d[a], m[a]);
    const std::size_t start = (static_cast<std::size_t>(base[2]) * T + base[1]) * T + base[0];
    Vec4 v = {}, gx = {}, gy = {}, gz = {}, cx = {}, cy = {}, cz = {};
    for (int k = 0; k < S; ++k) {
      Vec4 pv = {}, pgx = {}, pgy = {}, pcx = {}, pcy = {};
      for (int j = 0; j < S; ++j) {
        const Vec4* node = velocity + start + (k * T + j) * T;
        Vec4 rv = {}, rg = {}, rc = {};
        for (int i = 0; i < S; ++i) {
          rv += node[i] * splat(w[0][i]);
          rg += node[i] * splat(d[0][i]);
          if constexpr (Affine && Shape::apic > 0.0) rc += node[i] * splat(m[0][i]);
        }
        pv += rv * splat(w[1][j]);
        pgx += rg * splat(w[1][j]);
        pgy += rv * splat(d[1][j]);
        pcx += rc * splat(w[1][j]);
        pcy += rv * splat(m[1][j]);
      }
      v += pv * splat(w[2][k]);
      gx += pgx * splat(w[2][k]);
      gy += pgy * splat(w[2][k]);
      gz += pv * splat(d[2][k]);
      cx += pcx * splat(w[2][k]);
      cy += pcy * splat(w[2][k]);
      cz += pv * splat(m[2][k]);
    }
    std::array<double, 9> A;
    for (int i = 0; i < 3; ++i) {
      A[3 * i] = dt * h1 * gx[i];
      A[3 * i + 1] = dt * h1 * gy[i];
      A[3 * i + 2] = dt * h1 * gz[i];
    }
    const auto G = midpoint_gradient(A);
    for (int i = 0; i < 9; ++i) P.gradient[i][p] = G[i];
    double speed = 0.0;
    if constexpr (Flip) {
      Vec4 dv = {};
      for (int k = 0; k < S; ++k)
        for (int j = 0; j < S; ++j)
          for (int i = 0; i < S; ++i) dv += change[start + (k * T + j) * T + i] * splat(w[0][i] * w[1][j] * w[2][k]);
      for (int a = 0; a < 3; ++a) P.velocity[a][p] = s.flip * (P.velocity[a][p] + dv[a]) + (1.0 - s.flip) * v[a];
    } else {
      for (int i = 0; i < 3; ++i) P.velocity[i][p] = v[i];
    }
    if constexpr (Affine) {
      for (int i = 0; i < 3; ++i) {
        if constexpr (Shape::apic > 0.0) {
          P.affine[3 * i][p] = Shape::apic * h1 * cx[i];
          P.affine[3 * i + 1][p] = Shape::apic * h1 * cy[i];
          P.affine[3 * i + 2][p] = Shape::apic * h1 * cz[i];
        } else {
          P.affine[3 * i][p] = h1 * gx[i];
          P.affine[3 * i + 1][p] = h1 * gy[i];
          P.affine[3 * i + 2][p] = h1 * gz[i];
        }
      }
    }
    for (int a = 0; a < 3; ++a) {
      P.position[a][p] += dt * v[a];
      far = std::max(far, std::fabs(dt * v[a]));
      speed += P.velocity[a][p] * P.velocity[a][p];
    }
    fast = std::max(fast, speed);
    kinetic += 0.5 * P.mass[p] * speed;
  }
  return {far, fast, kinetic};
}

}  // namespace tailrun::mpm

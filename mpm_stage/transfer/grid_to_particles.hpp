// G2P: particles take velocity, affine velocity and displacement gradient from the grid, and move.
//
// One-dimensional sums are nested (x innermost), so each node is read once per particle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// Node velocity as the transfer wants it: (vx, vy, 0, 0) in 2-D, where the last two are for the velocity's change over
// the step, and (vx, vy, vz, 0) in 3-D.
template <int Dim>
inline Vec4 node_velocity(const double* v) {
  if constexpr (Dim == 2)
    return Vec4{v[0], v[1], 0.0, 0.0};
  else
    return Vec4{v[0], v[1], v[2], 0.0};
}

// Midpoint gradient G = A (I + A/2)^-1 of the increment F = I + A, A = dt grad v: sym(G) is a second-order strain
// increment that vanishes in any rigid rotation, skew(G) the Hughes & Winget (1980) rotation.
template <class Real>
[[gnu::always_inline]] inline std::array<Real, 4> midpoint_gradient(const std::array<Real, 4>& A) {
  const Real det = A[0] * A[3] - A[1] * A[2], r = 1.0 / (1.0 + 0.5 * (A[0] + A[3]) + 0.25 * det);
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
//
// C = sum w v* r^T / D keeps the angular momentum that the velocities sum w v* leave out. A particle that keeps the
// share `flip` of d = v_p - sum w v, what its velocity differs from the grid's before the step, has to keep that share
// of the difference of spins, too; and it moves with another velocity than its own, which turns dt v* x (flip d) about
// the origin. With flip skew(C_p - sum w v r^T / D) - [flip dt / (2 D) v* x d]x added to C, the angular momentum is
// kept to round-off, as in APIC.
struct GridToParticles {
  double dt;            // s
  double inverse_cell;  // 1/m
  double flip = 0.0;
  double kept_spin = 0.0;  // share of the difference of spins that is kept: `flip` once the particles have a spin
};

// Largest displacement component (m) and speed squared, and kinetic energy (J), of the particles begin .. end.
struct MotionExtremes {
  double displacement = 0.0;
  double speed_squared = 0.0;
  double kinetic = 0.0;
};

// Plane strain. `node` is the tile, `corner` (m) its node 0; a node is (vx, vy, change of vx, change of vy), of which
// the changes over the step count for FLIP alone. Four particles at a time: their nodes are transposed as they are
// read.
template <class Shape, bool Flip, bool Affine>
MotionExtremes grid_to_particles(const GridToParticles& s, const Vec4* __restrict node, const Vec4*,
                                 const std::array<double, 2>& corner, Particles<2>& P, std::size_t begin,
                                 std::size_t end) {
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  constexpr bool Moments = Affine && Shape::apic > 0.0;
  using At = ShapeAt<Shape>;
  const double h1 = s.inverse_cell, dt = s.dt;
  const double G0 = h1 * At::slope_unit, A0 = dt * G0, C0 = Shape::apic * h1 * At::moment_unit;
  Vec4 far = {}, fast = {}, kinetic = {};
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        const Vec4 x = g.read(P.position[0].data()), y = g.read(P.position[1].data());
        const At ax((x - corner[0]) * h1), ay((y - corner[1]) * h1);
        const Int4 at = whole(ay.base * T + ax.base);
        const Vec4 *n0 = node + at[0], *n1 = node + at[1], *n2 = node + at[2], *n3 = node + at[3];
        Vec4 v[2], gx[2] = {}, gy[2], cx[2] = {}, cy[2], change[2] = {}, row[2][S], spin_change = {}, across[S];
        for (int j = 0; j < S; ++j) {
          Vec4 u[2][S], row_change[2] = {}, du[S];
          for (int i = 0; i < S; ++i) {
            const int k = j * T + i;
            Vec4 lanes[4];
            if constexpr (Flip)
              transpose_nodes(n0[k], n1[k], n2[k], n3[k], lanes);
            else
              transpose_doubled(n0[k], n1[k], n2[k], n3[k], lanes);
            for (int c = 0; c < 2; ++c) {
              u[c][i] = lanes[c];
              if constexpr (Flip) row_change[c] += lanes[2 + c] * ax.w[i];
            }
            if constexpr (Flip) du[i] = lanes[3];
          }
          for (int c = 0; c < 2; ++c) {
            const LineSums line = ax.sums(u[c]);
            row[c][j] = line.value;
            gx[c] += line.slope * ay.w[j];
            if constexpr (Moments) cx[c] += line.moment * ay.w[j];
            if constexpr (Flip) change[c] += row_change[c] * ay.w[j];
          }
          if constexpr (Flip && Moments) {
            spin_change += ax.sums(du).moment * ay.w[j];
            across[j] = row_change[0];
          }
        }
        for (int c = 0; c < 2; ++c) {
          const LineSums line = ay.sums(row[c]);
          v[c] = line.value;
          gy[c] = line.slope;
          cy[c] = line.moment;
        }
        if constexpr (Flip && Moments) {
          spin_change -= ay.sums(across).moment;
          const Vec4 own = g.read(P.affine[2].data()) - g.read(P.affine[1].data());
          const Vec4 dx = g.read(P.velocity[0].data()) - v[0] + change[0];
          const Vec4 dy = g.read(P.velocity[1].data()) - v[1] + change[1];
          const Vec4 spin = (0.5 / C0) * (s.kept_spin * (own - C0 * (cx[1] - cy[0] - spin_change)) -
                                          (s.flip * dt * h1 * h1 * Shape::apic) * (v[0] * dy - v[1] * dx));
          cx[1] += spin;
          cy[0] -= spin;
        }
        if constexpr (Affine)
          for (int c = 0; c < 2; ++c) {
            g.write(P.affine[2 * c].data(), Moments ? C0 * cx[c] : G0 * gx[c]);
            g.write(P.affine[2 * c + 1].data(), Moments ? C0 * cy[c] : G0 * gy[c]);
          }
        const auto G = midpoint_gradient(std::array<Vec4, 4>{A0 * gx[0], A0 * gy[0], A0 * gx[1], A0 * gy[1]});
        for (int k = 0; k < 4; ++k) g.write(P.gradient[k].data(), G[k]);
        const Vec4 ux = dt * v[0], uy = dt * v[1];
        g.write(P.position[0].data(), x + ux);
        g.write(P.position[1].data(), y + uy);
        Vec4 speed = {};
        for (int c = 0; c < 2; ++c) {
          if constexpr (Flip) v[c] = s.flip * (g.read(P.velocity[c].data()) + change[c]) + (1.0 - s.flip) * v[c];
          g.write(P.velocity[c].data(), v[c]);
          speed += v[c] * v[c];
        }
        far = larger(far, larger(magnitude(ux), magnitude(uy)));
        fast = larger(fast, speed);
        kinetic += g.only(0.5 * g.read(P.mass.data()) * speed);
      });
  return {largest_lane(far), largest_lane(fast), sum_of_lanes(kinetic)};
}

// In three dimensions `velocity` and `change` (for FLIP) are tiles of their own.
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
      Vec4 dv = {}, px = {}, py = {}, pz = {};
      for (int k = 0; k < S; ++k)
        for (int j = 0; j < S; ++j)
          for (int i = 0; i < S; ++i) {
            const Vec4 node = change[start + (k * T + j) * T + i];
            dv += node * splat(w[0][i] * w[1][j] * w[2][k]);
            if constexpr (Affine && Shape::apic > 0.0) {
              px += node * splat(m[0][i] * w[1][j] * w[2][k]);
              py += node * splat(w[0][i] * m[1][j] * w[2][k]);
              pz += node * splat(w[0][i] * w[1][j] * m[2][k]);
            }
          }
      if constexpr (Affine && Shape::apic > 0.0) {
        const double C0 = Shape::apic * h1, half = 0.5 / C0, turn = s.flip * dt * C0 * h1;
        const double own[3] = {P.velocity[0][p] - v[0] + dv[0], P.velocity[1][p] - v[1] + dv[1],
                               P.velocity[2][p] - v[2] + dv[2]};
        // Twice the axial vectors: (C_zy - C_yz, C_xz - C_zx, C_yx - C_xy).
        const double sx =
            half * (s.kept_spin * (P.affine[7][p] - P.affine[5][p] - C0 * (cy[2] - cz[1] - py[2] + pz[1])) -
                    turn * (v[1] * own[2] - v[2] * own[1]));
        const double sy =
            half * (s.kept_spin * (P.affine[2][p] - P.affine[6][p] - C0 * (cz[0] - cx[2] - pz[0] + px[2])) -
                    turn * (v[2] * own[0] - v[0] * own[2]));
        const double sz =
            half * (s.kept_spin * (P.affine[3][p] - P.affine[1][p] - C0 * (cx[1] - cy[0] - px[1] + py[0])) -
                    turn * (v[0] * own[1] - v[1] * own[0]));
        cy[2] += sx;
        cz[1] -= sx;
        cz[0] += sy;
        cx[2] -= sy;
        cx[1] += sz;
        cy[0] -= sz;
      }
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

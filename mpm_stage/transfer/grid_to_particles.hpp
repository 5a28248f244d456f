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

// a x b of the first three lanes, 0 in the last.
[[gnu::always_inline]] inline Vec4 cross(Vec4 a, Vec4 b) {
  const Vec4 c = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - b * __builtin_shufflevector(a, a, 1, 2, 0, 3);
  return __builtin_shufflevector(c, Vec4{}, 1, 2, 0, 4);
}

// What the velocity of a particle is made of. `flip` is the share of FLIP: v <- flip (v + sum w dv) + (1 - flip) sum w
// v*. With Affine the particle also keeps the grid's affine velocity (Jiang et al. 2015); both together are AFLIP (Fei
// et al. 2021).
//
// C = sum w v* r^T / D, r = x_i - x_p and D the second moment of w, keeps the angular momentum that the velocities sum
// w v* leave out. Of d = v_p - sum w v and B = C_p - sum w v r^T / D, what a particle's velocity and affine velocity
// differ from the grid's before the step, it keeps the same share `flip`:
// - Energy. Let R be the way from the grid to the particles and S that back, V the nodes' velocities before and V*
// after
//   the step. R and S are adjoint to each other in the products of the kinetic energies, sum m V . V of the nodes and
//   sum m (v . v + D C : C) of the particles, and neither makes anything longer. So u <- R V* + flip (1 - R S) u, u
//   being the particles' (v, C), gives them no more than the grid gained: for flip = 1 it is u + R (V* - V), whose
//   energy grows by <V, V* - V> + |R (V* - V)|^2 / 2, for flip = 0 it is R V*, and in between the energy is convex in
//   flip. With d kept and the symmetric part of B dropped there is no such bound: d and C both have the motion of
//   neighbours against each other, C anew in each step, and what the grid's forces took from C (plastic work!) comes
//   back.
// - Angular momentum. A particle moves with sum w v* and not with its own velocity, which turns sum m flip dt sum w v*
// x
//   d. That is sum m flip dt l with
//     l = sum w (v* - sum w v*) x (v - C_p r) = (sum w v*) x (sum w dv) - sum w v* x dv - D sum_k C*_k x C_pk,
//   dv = v* - v and C_k the columns of C, for sum_p m w (v_p + C_p r - v) = 0 at every node. Without l / D, taken from
//   the axial vector of C times flip dt, angular momentum changes. l does not depend on the frame, and there is none
//   where the grid moves on as the particle does; (sum w v*) x d in its place makes energy in bodies that move.
struct GridToParticles {
  double dt;            // s
  double inverse_cell;  // 1/m
  double flip = 0.0;
  double kept_affine = 0.0;  // share of B that is kept: `flip` once the particles have an affine velocity
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
        Vec4 v[2], gx[2] = {}, gy[2], cx[2] = {}, cy[2], change[2] = {}, row[2][S];
        Vec4 turned = {}, change_x[2] = {}, change_row[2][S];
        for (int j = 0; j < S; ++j) {
          Vec4 u[2][S], row_change[2] = {}, du[2][S], row_turned = {};
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
            if constexpr (Flip && Moments) {
              du[0][i] = lanes[2];
              du[1][i] = lanes[3];
              row_turned += (lanes[0] * lanes[3] - lanes[1] * lanes[2]) * ax.w[i];
            }
          }
          for (int c = 0; c < 2; ++c) {
            const LineSums line = ax.sums(u[c]);
            row[c][j] = line.value;
            gx[c] += line.slope * ay.w[j];
            if constexpr (Moments) cx[c] += line.moment * ay.w[j];
            if constexpr (Flip) change[c] += row_change[c] * ay.w[j];
          }
          if constexpr (Flip && Moments) {
            turned += row_turned * ay.w[j];
            for (int c = 0; c < 2; ++c) {
              change_x[c] += ax.sums(du[c]).moment * ay.w[j];
              change_row[c][j] = row_change[c];
            }
          }
        }
        for (int c = 0; c < 2; ++c) {
          const LineSums line = ay.sums(row[c]);
          v[c] = line.value;
          gy[c] = line.slope;
          cy[c] = line.moment;
        }
        if constexpr (Flip && Moments) {
          const Vec4 c0x = g.read(P.affine[0].data()), c0y = g.read(P.affine[1].data());
          const Vec4 c1x = g.read(P.affine[2].data()), c1y = g.read(P.affine[3].data());
          // C0 times the moments of a velocity is its C; D C0 = h moment_unit.
          const Vec4 columns = (cx[0] * c1x - cx[1] * c0x + cy[0] * c1y - cy[1] * c0y) * (At::moment_unit / h1);
          const Vec4 l = v[0] * change[1] - v[1] * change[0] - turned - columns;
          const Vec4 spin = (0.5 * s.flip * dt * h1 / At::moment_unit) * l;
          const double per_C0 = 1.0 / C0;
          cx[0] += s.kept_affine * (per_C0 * c0x - (cx[0] - change_x[0]));
          cy[0] += s.kept_affine * (per_C0 * c0y - (cy[0] - ay.sums(change_row[0]).moment)) + spin;
          cx[1] += s.kept_affine * (per_C0 * c1x - (cx[1] - change_x[1])) - spin;
          cy[1] += s.kept_affine * (per_C0 * c1y - (cy[1] - ay.sums(change_row[1]).moment));
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
      Vec4 dv = {}, px = {}, py = {}, pz = {}, turned = {};
      for (int k = 0; k < S; ++k)
        for (int j = 0; j < S; ++j)
          for (int i = 0; i < S; ++i) {
            const int n = (k * T + j) * T + i;
            const Vec4 node = change[start + n];
            const double weight = w[0][i] * w[1][j] * w[2][k];
            dv += node * splat(weight);
            if constexpr (Affine && Shape::apic > 0.0) {
              px += node * splat(m[0][i] * w[1][j] * w[2][k]);
              py += node * splat(w[0][i] * m[1][j] * w[2][k]);
              pz += node * splat(w[0][i] * w[1][j] * m[2][k]);
              turned += cross(velocity[start + n], node) * splat(weight);
            }
          }
      if constexpr (Affine && Shape::apic > 0.0) {
        // C0 times the moments of a velocity is its C; D C0 = h.
        const double C0 = Shape::apic * h1, per_C0 = 1.0 / C0;
        const auto column = [&](int k) { return Vec4{P.affine[k][p], P.affine[3 + k][p], P.affine[6 + k][p], 0.0}; };
        const Vec4 own[3] = {column(0), column(1), column(2)};
        const Vec4 columns = (cross(cx, own[0]) + cross(cy, own[1]) + cross(cz, own[2])) * splat(1.0 / h1);
        const Vec4 spin = (cross(v, dv) - turned - columns) * splat(0.5 * s.flip * dt * h1);
        cx += splat(s.kept_affine) * (own[0] * splat(per_C0) - (cx - px)) + Vec4{0.0, -spin[2], spin[1], 0.0};
        cy += splat(s.kept_affine) * (own[1] * splat(per_C0) - (cy - py)) + Vec4{spin[2], 0.0, -spin[0], 0.0};
        cz += splat(s.kept_affine) * (own[2] * splat(per_C0) - (cz - pz)) + Vec4{-spin[1], spin[0], 0.0, 0.0};
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

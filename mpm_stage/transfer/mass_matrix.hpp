// The full mass matrix of the grid times a velocity field, M_ij = sum_p w_pi m_p w_pj: particles take the velocity from
// the nodes and give the momentum back. Nothing is assembled.
#pragma once

#include <array>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// A node's velocity (vx, vy, ., .) or (vx, vy, vz, .) as a momentum (0, px, py, 0) or (0, px, py, pz).
template <int Dim>
[[gnu::always_inline]] inline Vec4 as_momentum(Vec4 v) {
  if constexpr (Dim == 2)
    return __builtin_shufflevector(v, Vec4{}, 4, 0, 1, 4);
  else
    return __builtin_shufflevector(v, Vec4{}, 4, 0, 1, 2);
}
template <int Dim>
[[gnu::always_inline]] inline Vec4 as_velocity(Vec4 p) {
  if constexpr (Dim == 2)
    return __builtin_shufflevector(p, Vec4{}, 1, 2, 4, 4);
  else
    return __builtin_shufflevector(p, Vec4{}, 1, 2, 3, 4);
}

// Adds what the particles begin .. end make of the tile `velocity` (m/s) to the tile `momentum` (kg m/s, lanes 1 ..
// Dim). `corner` (m) is node 0 of the tile.
template <class Shape>
void apply_mass_matrix(double h1, const std::array<double, 2>& corner, const Particles<2>& P, std::size_t begin,
                       std::size_t end, const Vec4* __restrict velocity, Vec4* __restrict momentum) {
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        Vec4 wx[S], wy[S], unused[S], moment[S];
        const Int4 i0 = Shape::evaluate((g.read(P.position[0].data()) - corner[0]) * h1, wx, unused, moment);
        const Int4 j0 = Shape::evaluate((g.read(P.position[1].data()) - corner[1]) * h1, wy, unused, moment);
        const Vec4 m = g.read(P.mass.data());
        for (int k = 0; k < g.count; ++k) {
          const int at = j0[k] * T + i0[k];
          Vec4 w[S], v = {};
          for (int i = 0; i < S; ++i) w[i] = splat(wx[i][k]);
          for (int j = 0; j < S; ++j) {
            const Vec4* node = velocity + at + j * T;
            Vec4 row = {};
            for (int i = 0; i < S; ++i) row += node[i] * w[i];
            v += row * splat(wy[j][k]);
          }
          const Vec4 p = as_momentum<2>(v) * splat(m[k]);
          for (int j = 0; j < S; ++j) {
            Vec4* node = momentum + at + j * T;
            const Vec4 give = p * splat(wy[j][k]);
            for (int i = 0; i < S; ++i) node[i] += give * w[i];
          }
        }
      });
}

template <class Shape>
void apply_mass_matrix(double h1, const std::array<double, 3>& corner, const Particles<3>& P, std::size_t begin,
                       std::size_t end, const Vec4* __restrict velocity, Vec4* __restrict momentum) {
  constexpr int S = Shape::support, T = Tile<3, Shape>::side;
  for (std::size_t p = begin; p < end; ++p) {
    double w[3][S], unused[S], moment[S];
    int base[3];
    for (int a = 0; a < 3; ++a) base[a] = Shape::evaluate((P.position[a][p] - corner[a]) * h1, w[a], unused, moment);
    const std::size_t start = (static_cast<std::size_t>(base[2]) * T + base[1]) * T + base[0];
    Vec4 v = {};
    for (int k = 0; k < S; ++k)
      for (int j = 0; j < S; ++j) {
        const Vec4* node = velocity + start + (k * T + j) * T;
        Vec4 row = {};
        for (int i = 0; i < S; ++i) row += node[i] * splat(w[0][i]);
        v += row * splat(w[1][j] * w[2][k]);
      }
    v = as_momentum<3>(v) * splat(P.mass[p]);
    for (int k = 0; k < S; ++k)
      for (int j = 0; j < S; ++j) {
        Vec4* node = momentum + start + (k * T + j) * T;
        const Vec4 give = v * splat(w[1][j] * w[2][k]);
        for (int i = 0; i < S; ++i) node[i] += give * splat(w[0][i]);
      }
  }
}

}  // namespace tailrun::mpm

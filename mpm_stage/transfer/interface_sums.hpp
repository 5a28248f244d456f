// What contact between velocity fields has to know of each field's material around a node: how much there is, where its
// centre lies, how large its surface is, and what shear stress it carries.
//
// For the material of one field, with V_p the particles' volumes and w their weights at node i:
//   V = sum V_p w,   V c = sum V_p w (x_p - x_i),   G = sum V_p grad w,   V s = sum V_p w s_p.
// G is the surface of the field's material times its outward normal, as the node sees it: inside the sums vanish, and
// over all nodes they add up to the whole surface. Beside the sums, what the particles cover of the node's reach along
// each axis (covered_bins.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/covered_bins.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/soil_limit.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

struct InterfaceNode {
  using Line = CoveredBins<24>;
  Vec4 first;   // m3, m4: V and V c
  Vec4 second;  // m3 Pa, m2: V s and G
  std::array<std::uint32_t, 3> cover{};
  InterfaceNode& operator+=(const InterfaceNode& o) {
    first += o.first;
    second += o.second;
    for (std::size_t d = 0; d < cover.size(); ++d) cover[d] |= o.cover[d];
    return *this;
  }
  void add_cover(Line::Bits x, Line::Bits y, Line::Bits z) {
    cover[0] |= static_cast<std::uint32_t>(x);
    cover[1] |= static_cast<std::uint32_t>(y);
    cover[2] |= static_cast<std::uint32_t>(z);
  }
};

// Adds the particles begin .. end, which are of one material, to the tile `node` with its node 0 at `corner` (m), but
// for those whose first node is not `wanted`.
template <int Dim, class Shape>
void scatter_interface(const MaterialConstants& k, const Particles<Dim>& P, std::size_t begin, std::size_t end,
                       const std::array<double, Dim>& corner, double h1, const std::uint8_t* wanted,
                       InterfaceNode* node) {
  constexpr int S = Shape::support, T = Tile<Dim, Shape>::side;
  const double h = 1.0 / h1;
  for (std::size_t p = begin; p < end; ++p) {
    double w[3][S], d[3][S], m[3][S], X[3];
    int at = 0, base[3];
    for (int a = 0, stride = 1; a < Dim; ++a, stride *= T) {
      X[a] = (P.position[a][p] - corner[a]) * h1;
      base[a] = Shape::evaluate(X[a], w[a], d[a], m[a]);
      at += stride * base[a];
    }
    if (!wanted[at]) continue;
    const double V = P.volume[p], half = 0.5 * h1 * (Dim == 2 ? std::sqrt(V) : std::cbrt(V));
    InterfaceNode::Line::Bits bins[3][S] = {};
    for (int a = 0; a < Dim; ++a) InterfaceNode::Line::under<S>(X[a] - base[a], half, bins[a]);
    const double s = V * interface_strength(k, P.strength[p], P.plastic_strain[p]);
    const Vec4 scale = {V, -V * h, -V * h, -V * h}, slope_scale = {s, V * h1, V * h1, V * h1};
    Vec4 first_x[S], second_x[S], first_y[S], second_y[S];
    for (int i = 0; i < S; ++i) {
      first_x[i] = scale * Vec4{w[0][i], m[0][i], w[0][i], w[0][i]};
      second_x[i] = slope_scale * Vec4{w[0][i], d[0][i], w[0][i], w[0][i]};
      first_y[i] = Vec4{w[1][i], w[1][i], m[1][i], Dim == 3 ? w[1][i] : 0.0};
      second_y[i] = Vec4{w[1][i], w[1][i], d[1][i], Dim == 3 ? w[1][i] : 0.0};
    }
    InterfaceNode* from = node + at;
    if constexpr (Dim == 2) {
      for (int j = 0; j < S; ++j)
        for (int i = 0; i < S; ++i) {
          from[j * T + i].first += first_x[i] * first_y[j];
          from[j * T + i].second += second_x[i] * second_y[j];
          from[j * T + i].add_cover(bins[0][i], bins[1][j], 0);
        }
    } else {
      for (int l = 0; l < S; ++l)
        for (int j = 0; j < S; ++j) {
          const Vec4 first_z = first_y[j] * Vec4{w[2][l], w[2][l], w[2][l], m[2][l]};
          const Vec4 second_z = second_y[j] * Vec4{w[2][l], w[2][l], w[2][l], d[2][l]};
          for (int i = 0; i < S; ++i) {
            from[(l * T + j) * T + i].first += first_x[i] * first_z;
            from[(l * T + j) * T + i].second += second_x[i] * second_z;
            from[(l * T + j) * T + i].add_cover(bins[0][i], bins[1][j], bins[2][l]);
          }
        }
    }
  }
}

}  // namespace tailrun::mpm

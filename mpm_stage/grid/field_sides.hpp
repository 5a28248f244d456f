// Which side of weak soil the stronger soil lies on.
//
// A weak layer thinner than a node's reach has strong soil on both sides of it at the same nodes; in one velocity field
// the sides would hold each other through the layer. So strong particles near weak soil below them form a field of
// their own (after the partition by the gradient of a field, Homel & Herbold 2017). The sides of one soil that no weak
// soil keeps apart at a node go on as one there, so nothing is cut that belongs together.
#pragma once

#include <array>
#include <cmath>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/field_choice.hpp"
#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/grid/tiles.hpp"

namespace tailrun::mpm {

// w, grad w (per cell) and node number of each node around particle p: action(number, w, slope[Dim]).
template <int Dim, class Shape, class Action>
inline void for_each_node_around(const Particles<Dim>& P, std::size_t p, const std::array<double, Dim>& corner,
                                 double h1, Action action) {
  constexpr int S = Shape::support, T = Tile<Dim, Shape>::side;
  double w[3][S], d[3][S], m[3][S];
  int at = 0;
  for (int a = 0, stride = 1; a < Dim; ++a, stride *= T)
    at += stride * Shape::evaluate((P.position[a][p] - corner[a]) * h1, w[a], d[a], m[a]);
  for (int l = 0; l < (Dim == 3 ? S : 1); ++l)
    for (int j = 0; j < S; ++j)
      for (int i = 0; i < S; ++i) {
        const double wz = Dim == 3 ? w[2][l] : 1.0;
        std::array<double, Dim> slope;
        slope[0] = d[0][i] * w[1][j] * wz;
        slope[1] = w[0][i] * d[1][j] * wz;
        if constexpr (Dim == 3) slope[2] = w[0][i] * w[1][j] * d[2][l];
        action(at + (l * T + j) * T + i, w[0][i] * w[1][j] * wz, slope);
      }
}

// Sets P.side for the particles of field 0 by the gradient of the volume of field 1 along fields.up, on a grid that P
// has just been sorted for. `corner(b)` (m) is node 0 of block b's tile. Returns whether any changed.
template <int Dim, class Shape, class Corner>
bool find_sides(const BlockGrid<Dim>& grid, const FieldChoice& fields, Corner corner, Particles<Dim>& P) {
  constexpr int tile_nodes = Tile<Dim, Shape>::nodes, block_nodes = Block<Dim>::nodes;
  const double h1 = 1.0 / grid.cell_size(), per_cell = std::pow(h1, Dim);
  const auto base_field = [&](int material) { return fields.of_material[static_cast<std::size_t>(material)]; };
  AlignedVector<double> tiles(grid.occupied() * tile_nodes, 0.0), nodes(grid.active() * block_nodes);
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t b = 0; b < grid.occupied(); ++b)
    for (const Run& run : grid.runs(b))
      if (base_field(run.material) == 1)
        for (std::size_t p = run.begin; p < run.end; ++p)
          for_each_node_around<Dim, Shape>(P, p, corner(b), h1, [&](int n, double w, const auto&) {
            tiles[b * tile_nodes + static_cast<std::size_t>(n)] += w * P.volume[p] * per_cell;
          });
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < grid.active(); ++a)
    gather_tiles<Dim, Shape>(grid.tiles_around(a), tiles.data(), nodes.data() + a * block_nodes);
  bool changed = false;
#pragma omp parallel for schedule(dynamic, 4) reduction(|| : changed)
  for (std::size_t b = 0; b < grid.occupied(); ++b) {
    double tile[tile_nodes];
    load_tile<Dim, Shape>(grid, b, nodes.data(), tile);
    for (const Run& run : grid.runs(b))
      for (std::size_t p = run.begin; p < run.end; ++p) {
        std::int32_t side = 0;
        if (base_field(run.material) == 0) {
          double upwards = 0.0;
          for_each_node_around<Dim, Shape>(P, p, corner(b), h1, [&](int n, double, const auto& slope) {
            double rise = 0.0;
            for (int d = 0; d < Dim; ++d) rise += slope[d] * fields.up[static_cast<std::size_t>(d)];
            upwards += tile[n] * rise;
          });
          // Per cell; less is rounding, or the last trace of soil three cells away.
          side = upwards < -1e-6 ? 1 : 0;
        }
        changed = changed || side != P.side[p];
        P.side[p] = side;
      }
  }
  return changed;
}

}  // namespace tailrun::mpm

// Between tiles and nodes: the overlaps of a block with its neighbours' tiles, in both directions. Values are anything
// that can be copied and added (Vec4 for mass and momentum, pairs for averaged quantities).
#pragma once

#include <algorithm>

#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

// nodes[0 .. Block::nodes) = sum over the tiles around active block a; tiles hold Tile::nodes values per occupied
// block.
template <int Dim, class Shape, class Value>
inline void gather_tiles(const BlockGrid<Dim>& grid, std::size_t a, const Value* tiles, Value* nodes) {
  constexpr int B = Block<Dim>::cells, T = Tile<Dim, Shape>::side, low = Tile<Dim, Shape>::low;
  std::fill(nodes, nodes + Block<Dim>::nodes, Value{});
  const auto& around = grid.tiles_around(a);
  for (int n = 0; n < Block<Dim>::neighbours; ++n) {
    if (around[n] < 0) continue;
    const Value* tile = tiles + static_cast<std::size_t>(around[n]) * Tile<Dim, Shape>::nodes;
    // Node i of this block is node i - offset B - low of the tile of the block `offset` blocks away.
    int first[3] = {0, 0, 0}, last[3] = {1, 1, 1}, to_tile[3] = {0, 0, 0};
    for (int d = 0, m = n; d < Dim; ++d, m /= 3) {
      to_tile[d] = -(m % 3 - 1) * B - low;
      first[d] = std::max(0, -to_tile[d]);
      last[d] = std::min(B, T - to_tile[d]);
    }
    for (int k = first[2]; k < last[2]; ++k)
      for (int j = first[1]; j < last[1]; ++j) {
        Value* row = nodes + (k * B + j) * B;
        const Value* source = tile + ((k + to_tile[2]) * T + j + to_tile[1]) * T + to_tile[0];
        for (int i = first[0]; i < last[0]; ++i) row[i] += source[i];
      }
  }
}

// tile[0 .. Tile::nodes) = values of the nodes that occupied block b's tile covers. `of_block(a)` points to the
// Block::nodes values of active block a; where it is null the tile gets `otherwise`.
template <int Dim, class Shape, class Value, class OfBlock>
inline void load_tile_if(const BlockGrid<Dim>& grid, std::size_t b, OfBlock of_block, Value otherwise, Value* tile) {
  constexpr int B = Block<Dim>::cells, T = Tile<Dim, Shape>::side, low = Tile<Dim, Shape>::low;
  const auto& around = grid.active_around(b);
  for (int n = 0; n < Block<Dim>::neighbours; ++n) {
    const Value* block = of_block(static_cast<std::size_t>(around[n]));
    int first[3] = {0, 0, 0}, last[3] = {1, 1, 1}, to_tile[3] = {0, 0, 0};
    for (int d = 0, m = n; d < Dim; ++d, m /= 3) {
      to_tile[d] = (m % 3 - 1) * B - low;
      first[d] = std::max(0, -to_tile[d]);
      last[d] = std::min(B, T - to_tile[d]);
    }
    for (int k = first[2]; k < last[2]; ++k)
      for (int j = first[1]; j < last[1]; ++j) {
        Value* target = tile + ((k + to_tile[2]) * T + j + to_tile[1]) * T + to_tile[0];
        if (block)
          for (int i = first[0]; i < last[0]; ++i) target[i] = block[(k * B + j) * B + i];
        else
          for (int i = first[0]; i < last[0]; ++i) target[i] = otherwise;
      }
  }
}

// The same with Block::nodes values per active block one after the other.
template <int Dim, class Shape, class Value>
inline void load_tile(const BlockGrid<Dim>& grid, std::size_t b, const Value* nodes, Value* tile) {
  load_tile_if<Dim, Shape>(
      grid, b, [nodes](std::size_t a) { return nodes + a * Block<Dim>::nodes; }, Value{}, tile);
}

}  // namespace tailrun::mpm

// Between tiles and nodes: the overlaps of a block with its neighbours' tiles, in both directions. Values are anything
// that can be copied and added (Vec4 for mass and momentum, pairs for averaged quantities).
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

// What a block's nodes and the tile of the block at neighbour position `Position` of it have in common. All sizes are
// known to the compiler, so that a row is a few loads and stores, not a call.
template <int Dim, class Shape, int Position>
struct Overlap {
  static constexpr int B = Block<Dim>::cells, T = Tile<Dim, Shape>::side;
  // Node i of the block is node i + to_tile of the tile.
  static constexpr int to_tile(int d) {
    return d < Dim ? -neighbour_step<Dim>(Position)[static_cast<std::size_t>(d)] * B - Tile<Dim, Shape>::low : 0;
  }
  static constexpr int first(int d) { return d < Dim ? std::max(0, -to_tile(d)) : 0; }
  static constexpr int last(int d) { return d < Dim ? std::min(B, T - to_tile(d)) : 1; }
  static constexpr int length = last(0) - first(0);

  // row(n, t) for every row of `length` nodes, which begins at node n of the block and node t of the tile.
  template <class Row>
  [[gnu::always_inline]] static void for_each_row(Row row) {
    for (int k = first(2); k < last(2); ++k)
      for (int j = first(1); j < last(1); ++j)
        row((k * B + j) * B + first(0), ((k + to_tile(2)) * T + j + to_tile(1)) * T + first(0) + to_tile(0));
  }
};

template <int... Positions, class Action>
[[gnu::always_inline]] inline void for_each_position(std::integer_sequence<int, Positions...>, Action action) {
  (action(std::integral_constant<int, Positions>{}), ...);
}

// nodes[0 .. Block::nodes) = sum over the tiles `around` an active block (-1: none there); tiles hold Tile::nodes
// values per occupied block.
template <int Dim, class Shape, class Value>
inline void gather_tiles(const std::array<int, Block<Dim>::neighbours>& around, const Value* tiles, Value* nodes) {
  constexpr int own = Block<Dim>::neighbours / 2;
  const auto tile_at = [&](int n) { return tiles + static_cast<std::size_t>(around[n]) * Tile<Dim, Shape>::nodes; };
  if (around[own] < 0)
    std::fill(nodes, nodes + Block<Dim>::nodes, Value{});
  else
    Overlap<Dim, Shape, own>::for_each_row([ nodes, tile = tile_at(own) ](int n, int t) __attribute__((always_inline)) {
#pragma GCC unroll 8
      for (int i = 0; i < Block<Dim>::cells; ++i) nodes[n + i] = tile[t + i];
    });
  for_each_position(
      std::make_integer_sequence<int, Block<Dim>::neighbours>{}, [&]<int Position>(
                                                                     std::integral_constant<int, Position>)
                                                                     __attribute__((always_inline)) {
                                                                       using Shared = Overlap<Dim, Shape, Position>;
                                                                       if (Position == own || around[Position] < 0)
                                                                         return;
                                                                       Shared::for_each_row([
                                                                         nodes, tile = tile_at(Position)
                                                                       ](int n, int t) __attribute__((always_inline)) {
#pragma GCC unroll 8
                                                                         for (int i = 0; i < Shared::length; ++i)
                                                                           nodes[n + i] += tile[t + i];
                                                                       });
                                                                     });
}

// `count` values are going to be written soon: has their cache lines fetched meanwhile.
template <class Value>
[[gnu::always_inline]] inline void will_write(Value* values, std::size_t count) {
  constexpr std::size_t per_line = 64 / sizeof(Value);
  for (std::size_t k = 0; k < count; k += per_line) __builtin_prefetch(values + k, 1);
}

struct AsItIs {
  template <class Value>
  Value operator()(const Value& value) const {
    return value;
  }
};

// tile[0 .. Tile::nodes) = as(values of the nodes that occupied block b's tile covers). `of_block(a)` points to the
// Block::nodes values of active block a; where it is null the tile gets `otherwise`.
template <int Dim, class Shape, class Value, class OfBlock, class As = AsItIs>
inline void load_tile_if(const BlockGrid<Dim>& grid, std::size_t b, OfBlock of_block, Value otherwise, Value* tile,
                         As as = {}) {
  const auto& around = grid.active_around(b);
  for_each_position(
      std::make_integer_sequence<int, Block<Dim>::neighbours>{},
      [&]<int Position>(std::integral_constant<int, Position>) __attribute__((always_inline)) {
        // Seen from that block, the tile's is on the other side.
        using Shared = Overlap<Dim, Shape, Block<Dim>::neighbours - 1 - Position>;
        const auto* block = of_block(static_cast<std::size_t>(around[Position]));
        if (block)
          Shared::for_each_row([ tile, block, as ](int n, int t) __attribute__((always_inline)) {
#pragma GCC unroll 8
            for (int i = 0; i < Shared::length; ++i) tile[t + i] = as(block[n + i]);
          });
        else
          Shared::for_each_row([ tile, otherwise ](int, int t) __attribute__((always_inline)) {
#pragma GCC unroll 8
            for (int i = 0; i < Shared::length; ++i) tile[t + i] = otherwise;
          });
      });
}

// The same with Block::nodes values per active block one after the other.
template <int Dim, class Shape, class Of, class Value, class As = AsItIs>
inline void load_tile(const BlockGrid<Dim>& grid, std::size_t b, const Of* nodes, Value* tile, As as = {}) {
  load_tile_if<Dim, Shape>(
      grid, b, [nodes](std::size_t a) { return nodes + a * Block<Dim>::nodes; }, Value{}, tile, as);
}

}  // namespace tailrun::mpm

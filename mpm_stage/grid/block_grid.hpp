// The sparse background grid: cubes of `cells` cells a side, of which only those with particles ("occupied") and their
// neighbours ("active") exist, so memory and time follow the particles and not the domain's bounding box.
//
// Every occupied block owns a tile, its own nodes plus a margin, into which its particles add their mass and momentum.
// An active block's nodes are then the sums over the tiles that overlap it, taken in a fixed order: no atomics, and the
// same bits for any number of threads. The margin lets a particle drift one cell out of its block before all particles
// have to be sorted again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mpm_stage/grid/field_choice.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

constexpr int power(int base, int exponent) {
  return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

template <int Dim>
struct Block {
  static constexpr int cells = Dim == 2 ? 8 : 4;
  static constexpr int nodes = power(cells, Dim);
  static constexpr int neighbours = power(3, Dim);  // itself included, x fastest
};

// Neighbour position k as steps of -1, 0 or 1 in each direction.
template <int Dim>
constexpr std::array<int, Dim> neighbour_step(int k) {
  std::array<int, Dim> step{};
  for (int d = 0; d < Dim; ++d, k /= 3) step[d] = k % 3 - 1;
  return step;
}

// A node as seen from a block: the neighbour position of the block that has it, and its number there.
struct NodePlace {
  int block, node;
};

// The node `step` away from a block's node n, at most a block's side in each direction.
template <int Dim>
constexpr NodePlace node_place(int n, const std::array<int, Dim>& step) {
  constexpr int B = Block<Dim>::cells;
  NodePlace place{0, 0};
  for (int d = 0, stride = 1, three = 1; d < Dim; ++d, stride *= B, three *= 3, n /= B) {
    const auto i = static_cast<unsigned>(n % B + step[d] + B);
    place.block += static_cast<int>(i / B) * three;
    place.node += static_cast<int>(i % B) * stride;
  }
  return place;
}

// Its index in arrays of Block::nodes values per block, -1: none. `around` has the blocks at the neighbour positions
// (-1: none).
template <int Dim>
constexpr std::ptrdiff_t node_beside(const std::array<int, Block<Dim>::neighbours>& around, int n,
                                     const std::array<int, Dim>& step) {
  const NodePlace place = node_place<Dim>(n, step);
  const int block = around[place.block];
  return block < 0 ? -1 : static_cast<std::ptrdiff_t>(block) * Block<Dim>::nodes + place.node;
}

// Nodes of a tile: from `low` to `low + side - 1` in each direction, counted from the block's first node.
template <int Dim, class Shape>
struct Tile {
  static constexpr int low = -2;
  static constexpr int side = Block<Dim>::cells + (Shape::support == 4 ? 5 : 4);
  static constexpr int nodes = power(side, Dim);
};

// Consecutive particles of one block, one velocity field and one material.
struct Run {
  std::size_t begin, end;
  int material;
  int field = 0;
};

template <int Dim>
class BlockGrid {
 public:
  using Index = std::array<int, Dim>;

  // `shift` as in shape_functions.hpp; `origin` is a node (m).
  BlockGrid(double cell_size, std::array<double, Dim> origin, double shift);

  // Sorts the particles by block, field, material and previous order and rebuilds the blocks. Particles whose `keep`
  // flag is 0 are dropped (an empty span keeps all). Throws ComputationError when a particle is so far off that block
  // numbers overflow (more than 2^20 blocks from the origin) or its position is not finite.
  void sort(Particles<Dim>& particles, std::span<const std::uint8_t> keep = {}, const FieldChoice& fields = {});

  // The grid of particles that were sorted before and have drifted since: `occupied` blocks, in the order that
  // occupied_index() had, of which block b held the particles first[b] .. first[b + 1].
  void restore(const std::vector<Index>& occupied, const std::vector<std::size_t>& first,
               const Particles<Dim>& particles, const FieldChoice& fields);

  double cell_size() const { return cell_size_; }
  const std::array<double, Dim>& origin() const { return origin_; }

  std::size_t occupied() const { return occupied_index_.size(); }
  std::size_t active() const { return active_index_.size(); }
  const Index& occupied_index(std::size_t b) const { return occupied_index_[b]; }  // in blocks
  const Index& active_index(std::size_t a) const { return active_index_[a]; }
  // Node n of active block a, in nodes from the origin.
  Index node_index(std::size_t a, int n) const {
    Index node;
    for (int d = 0; d < Dim; ++d, n /= Block<Dim>::cells)
      node[d] = active_index_[a][d] * Block<Dim>::cells + n % Block<Dim>::cells;
    return node;
  }
  std::size_t first_particle(std::size_t b) const { return first_[b]; }
  std::size_t last_particle(std::size_t b) const { return first_[b + 1]; }
  const std::vector<Index>& occupied_indices() const { return occupied_index_; }
  const std::vector<std::size_t>& first_particles() const { return first_; }
  std::span<const Run> runs(std::size_t b) const {
    return {runs_.data() + first_run_[b], first_run_[b + 1] - first_run_[b]};
  }
  // Active blocks around occupied block b, and occupied blocks (-1: none) around active block a.
  const std::array<int, Block<Dim>::neighbours>& active_around(std::size_t b) const { return active_around_[b]; }
  const std::array<int, Block<Dim>::neighbours>& tiles_around(std::size_t a) const { return tiles_around_[a]; }
  // Active block at neighbour position k of active block a, -1: none. A search; not for inner loops.
  int active_beside(std::size_t a, int k) const;
  std::size_t bytes() const;

 private:
  void connect();  // neighbours of the occupied blocks

  double cell_size_, shift_;
  std::array<double, Dim> origin_;
  std::vector<Index> occupied_index_, active_index_;
  std::vector<std::size_t> first_, first_run_;
  std::vector<Run> runs_;
  std::vector<std::array<int, Block<Dim>::neighbours>> active_around_, tiles_around_;
  std::vector<std::uint64_t> active_keys_;
  std::vector<std::uint32_t> order_, rank_;
  AlignedVector<double> spare_;
  AlignedVector<std::int32_t> spare_integers_;
};

}  // namespace tailrun::mpm

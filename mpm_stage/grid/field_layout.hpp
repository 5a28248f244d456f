// Where the velocity fields are: each has sums and velocities of its own in the blocks whose nodes its particles can
// come to before the next sort, one field's after the other's. Tile or node block k of field f stands at number f *
// (occupied or active blocks) + k.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

// Consecutive particles of one block and one field.
struct FieldSpan {
  std::size_t begin, end;
  int field;
};

template <int Dim>
class FieldLayout {
 public:
  using Around = std::array<int, Block<Dim>::neighbours>;

  // The nodes that particles come to before the next sort, from `low` to `high` in each direction, counted from their
  // block's first node.
  struct Reach {
    std::array<int, Dim> low, high;
  };

  // Call after each sort. reach(b, begin, end) is that of the particles begin .. end, which lie in occupied block b.
  template <class ReachOf>
  void update(const BlockGrid<Dim>& grid, int count, ReachOf reach) {
    grid_ = &grid;
    count_ = count;
    spans_.clear();
    first_span_.clear();
    std::vector<std::uint32_t> reached(static_cast<std::size_t>(count_) * grid.occupied(), 0);
    for (std::size_t b = 0; b < grid.occupied(); ++b) {
      first_span_.push_back(spans_.size());
      for (const Run& run : grid.runs(b)) {
        if (spans_.size() == first_span_.back() || spans_.back().field != run.field)
          spans_.push_back({run.begin, run.end, run.field});
        spans_.back().end = run.end;
      }
      for (std::size_t k = first_span_.back(); k < spans_.size(); ++k)
        reached[tile(spans_[k].field, b)] = neighbours_in(reach(b, spans_[k].begin, spans_[k].end));
    }
    first_span_.push_back(spans_.size());

    around_.resize(static_cast<std::size_t>(count_) * grid.active());
    fields_at_.assign(grid.active(), 0);
    for (int f = 0; f < count_; ++f)
      for (std::size_t a = 0; a < grid.active(); ++a) {
        Around& around = around_[number(f, a)];
        around = grid.tiles_around(a);
        bool any = false;
        for (int k = 0; k < Block<Dim>::neighbours; ++k) {
          int& b = around[static_cast<std::size_t>(k)];
          // Seen from that block, this one is on the other side.
          const int position = Block<Dim>::neighbours - 1 - k;
          if (b >= 0 && !(reached[tile(f, static_cast<std::size_t>(b))] >> position & 1U)) b = -1;
          any = any || b >= 0;
        }
        if (any) fields_at_[a] |= static_cast<std::uint8_t>(1U << f);
      }
    shared_.clear();
    shared_number_.assign(grid.active(), -1);
    for (std::size_t a = 0; a < grid.active(); ++a) {
      if (!shared(a)) continue;
      shared_number_[a] = static_cast<int>(shared_.size());
      shared_.push_back(a);
    }
    shared_around_.resize(shared_.size());
    for (std::size_t s = 0; s < shared_.size(); ++s)
      for (int k = 0; k < Block<Dim>::neighbours; ++k) {
        const int other = grid.active_beside(shared_[s], k);
        shared_around_[s][static_cast<std::size_t>(k)] =
            other < 0 ? -1 : shared_number_[static_cast<std::size_t>(other)];
      }
    near_shared_.assign(grid.occupied(), 0);
    for (std::size_t b = 0; b < grid.occupied(); ++b)
      for (const int a : grid.active_around(b))
        if (shared(static_cast<std::size_t>(a))) near_shared_[b] = 1;
  }

  int count() const { return count_; }
  bool several() const { return count_ > 1; }
  // Number of field f's node block a.
  std::size_t number(int f, std::size_t a) const { return static_cast<std::size_t>(f) * grid_->active() + a; }
  // Number of field f's tile of occupied block b.
  std::size_t tile(int f, std::size_t b) const { return static_cast<std::size_t>(f) * grid_->occupied() + b; }
  // Whether particles of field f reach active block a, and whether those of two fields do.
  bool present(int f, std::size_t a) const { return (fields_at_[a] >> f & 1U) != 0; }
  bool shared(std::size_t a) const { return (fields_at_[a] & (fields_at_[a] - 1U)) != 0; }
  // Whether nodes that two fields reach may be among those of occupied block b's tile.
  bool near_shared(std::size_t b) const { return near_shared_[b] != 0; }
  // The active blocks that several fields reach, the number of active block a among them (-1: it is none), and the
  // numbers of those around number s (-1: none).
  const std::vector<std::size_t>& shared_blocks() const { return shared_; }
  int shared_number(std::size_t a) const { return shared_number_[a]; }
  const Around& shared_around(std::size_t s) const { return shared_around_[s]; }
  // Occupied blocks around active block a with particles of field f that reach it; -1: none.
  const Around& around(int f, std::size_t a) const { return around_[number(f, a)]; }
  // action(span) for the particles of occupied block b, field by field.
  template <class Action>
  void for_each_span(std::size_t b, Action action) const {
    for (std::size_t k = first_span_[b]; k < first_span_[b + 1]; ++k) action(spans_[k]);
  }

 private:
  // The neighbour positions of the blocks whose nodes are in reach, as bits.
  static std::uint32_t neighbours_in(const Reach& reach) {
    constexpr int B = Block<Dim>::cells;
    std::uint32_t bits = 0;
    for (int k = 0; k < Block<Dim>::neighbours; ++k) {
      const auto step = neighbour_step<Dim>(k);
      bool in = true;
      for (int d = 0; d < Dim; ++d) in = in && reach.low[d] < (step[d] + 1) * B && reach.high[d] >= step[d] * B;
      if (in) bits |= std::uint32_t{1} << k;
    }
    return bits;
  }

  const BlockGrid<Dim>* grid_ = nullptr;
  int count_ = 1;
  std::vector<FieldSpan> spans_;
  std::vector<std::size_t> first_span_;
  std::vector<Around> around_, shared_around_;
  std::vector<std::size_t> shared_;
  std::vector<int> shared_number_;
  std::vector<std::uint8_t> fields_at_, near_shared_;
};

}  // namespace tailrun::mpm

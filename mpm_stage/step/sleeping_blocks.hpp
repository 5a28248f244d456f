// Blocks at rest are left out of the step: no G2P, stress or P2G; their particles' mass and forces stay on the nodes.
//
// A block falls asleep when none of its particles has been faster than `speed` for the time `calm`, and loses what
// velocity it has. It wakes when a node that its particles reach moves faster than that, and in any case after the time
// `nap`: a force out of balance that the nodes show only as velocity over a step is felt then, for soil that has lost
// its support is faster than `speed` well before `calm` is over. Asleep, a block's wave speed still limits the time
// step: it may wake, and strain, in any step.
//
// One clock per occupied block says all: the time (s) that the block has been calm, or minus the time until it wakes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

template <int Dim>
class SleepingBlocks {
 public:
  explicit SleepingBlocks(const SleepOptions& options) : options_(options) {}

  bool active() const { return options_.speed > 0.0; }
  bool asleep(std::size_t b) const { return active() && clock_[b] < 0.0; }
  double speed() const { return options_.speed; }
  const std::vector<double>& clocks() const { return clock_; }

  // Whether block b has to be put on the nodes again although it sleeps: it has just fallen asleep, or all blocks were
  // laid out anew.
  bool stale(std::size_t b) const { return stale_[b] != 0; }
  void put_on_nodes(std::size_t b) { stale_[b] = 0; }

  void wake(std::size_t b) { clock_[b] = 0.0; }
  void wake_all() { std::fill(clock_.begin(), clock_.end(), 0.0); }
  // A sleeping block's time goes by. Returns whether it sleeps on.
  bool doze(std::size_t b, double dt) {
    clock_[b] += dt;
    if (clock_[b] >= 0.0) clock_[b] = 0.0;
    return clock_[b] < 0.0;
  }
  // A waking block's, whose fastest particle moved with sqrt(speed_squared). Returns whether it falls asleep now.
  bool fall_asleep(std::size_t b, double speed_squared, double dt) {
    clock_[b] = speed_squared < options_.speed * options_.speed ? clock_[b] + dt : 0.0;
    if (clock_[b] < options_.calm) return false;
    clock_[b] = -options_.nap;
    stale_[b] = 1;
    return true;
  }

  // Before a sort: remembers which block has which clock. After it: blocks keep theirs; `moves(b)` says whether a
  // particle of block b is not at rest, which wakes it.
  void before_sort(const BlockGrid<Dim>& grid) {
    before_.clear();
    for (std::size_t b = 0; b < clock_.size(); ++b) before_[grid.occupied_index(b)] = clock_[b];
  }
  template <class Moves>
  void after_sort(const BlockGrid<Dim>& grid, Moves moves) {
    clock_.assign(grid.occupied(), 0.0);
    stale_.assign(grid.occupied(), 1);
    for (std::size_t b = 0; b < grid.occupied(); ++b)
      if (const auto it = before_.find(grid.occupied_index(b)); it != before_.end())
        clock_[b] = it->second < 0.0 && moves(b) ? 0.0 : it->second;
  }
  void restore(std::vector<double> clocks) {
    clock_ = std::move(clocks);
    stale_.assign(clock_.size(), 1);
  }

 private:
  SleepOptions options_;
  std::vector<double> clock_;        // s, per occupied block
  std::vector<std::uint8_t> stale_;  // per occupied block
  std::map<std::array<int, Dim>, double> before_;
};

}  // namespace tailrun::mpm

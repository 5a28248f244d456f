// The terrain as grid nodes see it: for every node of an active block near the ground its distance and normal. Blocks
// are looked up once in a run and remembered, whatever the number of terrain segments.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mpm_stage/boundary/terrain.hpp"
#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

struct NodeContact {
  int count = 0;
  bool adhere = false;
  std::array<TerrainPoint, 2> point;
};

template <int Dim>
class ContactNodes {
 public:
  // Nodes whose distance is under `reach` (m) are in contact when they move towards the ground.
  ContactNodes(const Terrain& terrain, double reach) : terrain_(terrain), reach_(reach) {}

  // Looks up the active blocks of `grid`; call after each sort.
  void update(const BlockGrid<Dim>& grid);

  // Contacts of the nodes of active block a, or null when none of them touches the ground.
  const NodeContact* of_block(std::size_t a) const {
    return block_start_.empty() || block_start_[a] < 0 ? nullptr : contacts_.data() + block_start_[a];
  }

 private:
  const Terrain& terrain_;
  double reach_;
  std::unordered_map<std::uint64_t, std::ptrdiff_t> known_;
  std::vector<std::ptrdiff_t> block_start_;
  std::vector<NodeContact> contacts_;
};

}  // namespace tailrun::mpm

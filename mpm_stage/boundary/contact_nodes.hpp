// The terrain as grid nodes see it: for every node of an active block near the ground its distance and normal. Blocks
// are looked up once in a run and remembered, whatever the number of terrain segments.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mpm_stage/boundary/ground_cover.hpp"
#include "mpm_stage/boundary/terrain.hpp"
#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

struct NodeContact {
  int count = 0;
  bool adhere = false;
  // Beyond contact's reach (count is 0), but the ground's surface lies within the node's function: point[0] is that of
  // the ground beside it.
  bool beside = false;
  std::array<TerrainPoint, 2> point;
};

template <int Dim>
class ContactNodes {
 public:
  // Nodes whose distance is under `reach` (m) are in contact when they move towards the ground.
  ContactNodes(const Terrain& terrain, double reach) : terrain_(terrain), reach_(reach) {}

  // Looks up the active blocks of `grid`; call after each sort.
  void update(const BlockGrid<Dim>& grid);

  // Active blocks with contacts around active block a, which must have contacts itself; -1: none there.
  const std::array<int, Block<Dim>::neighbours>& contact_around(std::size_t a) const { return around_[a]; }
  bool any() const { return !contacts_.empty(); }
  // Contacts of the nodes of active block a, or null when the ground is too far off for any particle there to touch it.
  const NodeContact* of_block(std::size_t a) const {
    return block_start_.empty() || block_start_[a] < 0 ? nullptr : contacts_.data() + block_start_[a];
  }
  // Signed distance (m) of the same nodes.
  const double* distances(std::size_t a) const { return distances_.data() + block_start_[a]; }
  // What they stand for of the ground's surface.
  const GroundShare<Dim>* surfaces(std::size_t a) const { return surfaces_.data() + block_start_[a]; }
  // Whether occupied block b or a neighbour of it has nodes near the ground.
  bool near_ground(std::size_t b) const { return !near_.empty() && near_[b]; }

 private:
  const Terrain& terrain_;
  double reach_;
  std::unordered_map<std::uint64_t, std::ptrdiff_t> known_;
  std::vector<std::ptrdiff_t> block_start_;
  std::vector<NodeContact> contacts_;
  std::vector<double> distances_;
  std::vector<GroundShare<Dim>> surfaces_;
  std::vector<std::uint8_t> near_;
  std::vector<std::array<int, Block<Dim>::neighbours>> around_;
};

}  // namespace tailrun::mpm

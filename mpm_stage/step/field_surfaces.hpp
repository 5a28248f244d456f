// The surfaces of the materials in each velocity field, for contact between them; included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/grid/binomial_sums.hpp"
#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// The surfaces of the materials in block b, for contact: of particles that reach nodes at which fields met in the last
// step. A node where they meet for the first time has a trace of the one, and waits for the next time.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::scatter_interfaces(std::size_t b) {
  constexpr int S = Shape::support, T = Tile<Dim, Shape>::side;
  std::uint8_t meet[tile_nodes], wanted[tile_nodes];
  load_tile<Dim, Shape>(grid_, b, meeting_.data(), meet);
  for (int n = 0; n < tile_nodes; ++n) {
    int last = n;  // of the nodes of a particle whose first one is n
    std::uint8_t any = 0;
    for (int l = 0; l < (Dim == 3 ? S : 1); ++l)
      for (int j = 0; j < S; ++j)
        for (int i = 0; i < S; ++i) {
          last = n + (l * T + j) * T + i;
          if (last < tile_nodes) any |= meet[last];
        }
    wanted[n] = any;
  }
  int field = -1;
  for (const Run& run : grid_.runs(b)) {
    InterfaceNode* tile = interface_tiles_.data() + fields_.tile(run.field, b) * tile_nodes;
    if (run.field != field) std::fill_n(tile, tile_nodes, InterfaceNode{});
    field = run.field;
    scatter_interface<Dim, Shape>(constants_[run.material], P_, run.begin, run.end, corner(b), h1_, wanted, tile);
  }
}

// The surfaces of the fields at the nodes at which they met in the last step.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::gather_interfaces() {
  const std::vector<std::size_t>& blocks = fields_.shared_blocks();
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s) {
    std::uint8_t* meeting = meeting_.data() + blocks[s] * block_nodes;
    std::fill_n(known_meeting_.begin() + static_cast<std::ptrdiff_t>(s * block_nodes), block_nodes, NodeMeeting{});
    const bool any = std::any_of(meeting, meeting + block_nodes, [](std::uint8_t m) { return m != not_met; });
    for (int f = 0; f < fields_.count(); ++f) {
      InterfaceNode* node = interfaces_.data() + interface_of(f, blocks[s]);
      if (any && fields_.present(f, blocks[s]))
        gather_tiles<Dim, Shape>(fields_.around(f, blocks[s]),
                                 interface_tiles_.data() + fields_.tile(f, 0) * tile_nodes, node);
      for (int n = 0; n < block_nodes; ++n)
        if (meeting[n] == not_met || !any) node[n] = InterfaceNode{};  // its sums are not whole
    }
    for (int n = 0; any && n < block_nodes; ++n)
      if (meeting[n] != not_met) meeting[n] = surface_known;
  }
}

// The firm fields' surfaces around the nodes of blocks in which fields met. Over as many nodes as this: particles that
// lie in rows along the grid make stairs of a slanting bed, with steps several cells long.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::smooth_surfaces() {
  const std::vector<std::size_t>& blocks = fields_.shared_blocks();
  surfaces_.resize(interfaces_.size());
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s) {
    const std::uint8_t* meeting = meeting_.data() + blocks[s] * block_nodes;
    if (std::none_of(meeting, meeting + block_nodes, [](std::uint8_t m) { return m != not_met; })) continue;
    for (int f = 0; f < fields_.count(); ++f) {
      if (!options_.fields.firm(f) || !fields_.present(f, blocks[s])) continue;
      const InterfaceNode* nodes = interfaces_.data() + interface_of(f, blocks[0]);
      BinomialSums<Dim>().make(
          fields_.shared_around(s),
          [nodes](std::size_t k) {
            Vec4 face = nodes[k].second;  // and its size in the place of the strength
            face[0] = std::sqrt(face[1] * face[1] + face[2] * face[2] + face[3] * face[3]);
            return face;
          },
          surfaces_.data() + interface_of(f, blocks[s]));
    }
  }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
SurfaceAround<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::surface_around(int f, std::size_t a, int n) const {
  const Vec4& sum = surfaces_[interface_of(f, a) + static_cast<std::size_t>(n)];
  SurfaceAround<Dim> surface;
  surface.faces = sum[0];
  for (int d = 0; d < Dim; ++d) surface.outward[d] = sum[1 + d];
  return surface;
}

}  // namespace tailrun::mpm

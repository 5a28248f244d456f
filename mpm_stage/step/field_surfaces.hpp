// The surfaces of the materials in each velocity field, for contact between them; included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// The surfaces of the materials in block b, for contact: of particles that reach nodes at which fields met in the last
// step. A node where they meet for the first time has a trace of the one, and waits for the next.
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
    const std::uint8_t* met = meeting_.data() + blocks[s] * block_nodes;
    const bool any = std::any_of(met, met + block_nodes, [](std::uint8_t m) { return m != 0; });
    for (int f = 0; f < fields_.count(); ++f) {
      InterfaceNode* node = interfaces_.data() + interface_of(f, blocks[s]);
      if (any && fields_.present(f, blocks[s]))
        gather_tiles<Dim, Shape>(fields_.around(f, blocks[s]),
                                 interface_tiles_.data() + fields_.tile(f, 0) * tile_nodes, node);
      for (int n = 0; n < block_nodes; ++n)
        if (!met[n] || !any) node[n] = InterfaceNode{};  // its sums are not whole
    }
  }
}

// What a node and those beside it have, by weights 2^Dim, half of it beside, a quarter across corners: `at` (in a row
// of blocks) gives the outward surface and its size.
template <int Dim, class At>
SurfaceAround<Dim> sum_around(const std::array<int, Block<Dim>::neighbours>& around, int n, At at) {
  SurfaceAround<Dim> sum;
  for (int s = 0; s < Block<Dim>::neighbours; ++s) {
    const auto step = neighbour_step<Dim>(s);
    const auto k = node_beside<Dim>(around, n, step);
    if (k < 0) continue;
    double weight = 1.0;
    for (int d = 0; d < Dim; ++d) weight *= step[d] == 0 ? 2.0 : 1.0;
    const SurfaceAround<Dim> surface = at(static_cast<std::size_t>(k));
    for (int d = 0; d < Dim; ++d) sum.outward[d] += weight * surface.outward[d];
    sum.faces += weight * surface.faces;
  }
  return sum;
}

// The firm fields' surfaces, smoothed once. Twice, in surface_around(): particles that lie in rows along the grid make
// stairs of a slanting bed, with steps several cells long.
template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::smooth_surfaces() {
  const std::vector<std::size_t>& blocks = fields_.shared_blocks();
  surfaces_.resize(interfaces_.size());
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t s = 0; s < blocks.size(); ++s)
    for (int f = 0; f < fields_.count(); ++f) {
      if (!options_.fields.firm(f)) continue;
      const InterfaceNode* nodes = interfaces_.data() + interface_of(f, blocks[0]);
      for (int n = 0; n < block_nodes; ++n)
        surfaces_[interface_of(f, blocks[s]) + static_cast<std::size_t>(n)] =
            sum_around<Dim>(fields_.shared_around(s), n, [nodes](std::size_t k) {
              SurfaceAround<Dim> surface;
              for (int d = 0; d < Dim; ++d) surface.outward[d] = nodes[k].second[1 + d];
              surface.faces = std::sqrt(square<Dim>(surface.outward));
              return surface;
            });
    }
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
SurfaceAround<Dim> ExplicitSolver<Dim, Shape, Split, Transfer>::surface_around(int f, std::size_t a, int n) const {
  const SurfaceAround<Dim>* nodes = surfaces_.data() + interface_of(f, fields_.shared_blocks()[0]);
  return sum_around<Dim>(fields_.shared_around(static_cast<std::size_t>(fields_.shared_number(a))), n,
                         [nodes](std::size_t k) { return nodes[k]; });
}

}  // namespace tailrun::mpm

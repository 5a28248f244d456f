#include "mpm_stage/boundary/mirror_walls.hpp"

namespace tailrun::mpm {

template <int Dim>
void MirrorWalls<Dim>::update(const BlockGrid<Dim>& grid, const WallNodes<Dim>& walls, int reach) {
  constexpr int B = Block<Dim>::cells;
  pairs_.clear();
  for (int d = 0; d < Dim; ++d)
    for (int s = 0; s < 2; ++s) {
      const auto& wall = walls.side[d][s];
      if (wall.kind != WallKind::fixed && wall.kind != WallKind::slip) continue;
      for (std::size_t a = 0; a < grid.active(); ++a) {
        const int first = grid.active_index(a)[d] * B;
        if (first > wall.node + reach || first + B <= wall.node - reach) continue;
        for (int n = 0; n < Block<Dim>::nodes; ++n) {
          const int inwards = grid.node_index(a, n)[d] - wall.node, depth = s == 0 ? inwards : -inwards;
          if (depth < 0 || depth > reach) continue;
          std::array<int, Dim> to_image{};
          to_image[d] = -2 * inwards;
          const NodePlace image = node_place<Dim>(n, to_image);
          const int block = grid.active_beside(a, image.block);
          pairs_.push_back({a * Block<Dim>::nodes + static_cast<std::size_t>(n),
                            block < 0 ? -1 : static_cast<std::ptrdiff_t>(block) * Block<Dim>::nodes + image.node, d,
                            wall.kind == WallKind::fixed});
        }
      }
    }
}

template <int Dim>
void MirrorWalls<Dim>::fold(Vec4* sums) const {
  for (const Pair& p : pairs_) {
    if (p.behind < 0) continue;
    if (static_cast<std::size_t>(p.behind) == p.inside) {
      // On the wall what changes sign cancels its image; the rest, mass with it, is half of the symmetric whole.
      for (int d = 0; d < Dim; ++d)
        if (p.fixed || d == p.direction) sums[p.inside][1 + d] = 0.0;
      continue;
    }
    Vec4 image = sums[p.behind];
    for (int d = 0; d < Dim; ++d)
      if (p.fixed || d == p.direction) image[1 + d] = -image[1 + d];
    sums[p.inside] += image;
    sums[p.behind] = Vec4{};
  }
}

template <int Dim>
void MirrorWalls<Dim>::reflect(Vec4* velocity) const {
  for (const Pair& p : pairs_) {
    Vec4 image = velocity[p.inside];
    for (int lane = 0; lane < 4; ++lane)
      if (p.fixed || lane % (Dim == 2 ? 2 : 4) == p.direction) image[lane] = -image[lane];
    if (static_cast<std::size_t>(p.behind) == p.inside)
      velocity[p.inside] = 0.5 * (velocity[p.inside] + image);
    else if (p.behind >= 0)
      velocity[p.behind] = image;
  }
}

template class MirrorWalls<2>;
template class MirrorWalls<3>;

}  // namespace tailrun::mpm

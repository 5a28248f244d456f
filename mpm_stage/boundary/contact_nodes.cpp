#include "mpm_stage/boundary/contact_nodes.hpp"

#include <cmath>

#include "mpm_stage/boundary/ground_surface.hpp"

namespace tailrun::mpm {

template <int Dim>
void ContactNodes<Dim>::update(const BlockGrid<Dim>& grid) {
  if (terrain_.empty()) return;
  constexpr int B = Block<Dim>::cells;
  const double h = grid.cell_size(), far = 1.5 * std::sqrt(2.0) * h;
  block_start_.resize(grid.active());
  for (std::size_t a = 0; a < grid.active(); ++a) {
    const auto& index = grid.active_index(a);
    // The ground is the same at every z, so blocks above one another in z share their contacts.
    const std::uint64_t key =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(index[0])) << 32) | static_cast<std::uint32_t>(index[1]);
    const auto [it, is_new] = known_.try_emplace(key, -1);
    if (is_new) {
      const double x0 = grid.origin()[0] + index[0] * B * h, y0 = grid.origin()[1] + index[1] * B * h;
      const double half = 0.5 * (B - 1) * h;
      // A particle within two cells of a node in contact, and the nodes around it, count as near.
      if (terrain_.distance(x0 + half, y0 + half) < reach_ + 4.0 * h + 1.4143 * half) {
        it->second = static_cast<std::ptrdiff_t>(contacts_.size());
        const GroundSurface<B, GroundShare<Dim>::bins> surface(terrain_, x0, y0, h);
        for (int n = 0; n < Block<Dim>::nodes; ++n) {
          const int i = n % B, j = n / B % B;
          NodeContact node;
          const double x = x0 + i * h, y = y0 + j * h;
          node.count = terrain_.contacts(x, y, reach_, node.point, node.adhere);
          if (node.count == 0 && surface[j * B + i] > 0.0)
            node.beside = terrain_.contacts(x, y, far, node.point, node.adhere) > 0;
          contacts_.push_back(node);
          distances_.push_back(terrain_.distance(x, y));
          const double width = Dim == 3 ? h : 1.0;
          GroundShare<Dim> share;
          if (node.count > 0 || node.beside) {
            const auto& normal = node.point[0].normal;
            share.axis = std::fabs(normal[0]) > std::fabs(normal[1]) ? 1 : 0;
          }
          share.whole = surface[j * B + i] * width;
          share.part = surface.parts(j * B + i, share.axis);
          for (float& part : share.part) part *= static_cast<float>(width);
          surfaces_.push_back(share);
        }
      }
    }
    block_start_[a] = it->second;
  }
  near_.assign(grid.occupied(), 0);
  for (std::size_t b = 0; b < grid.occupied(); ++b)
    for (const int a : grid.active_around(b))
      if (block_start_[static_cast<std::size_t>(a)] >= 0) near_[b] = 1;

  around_.resize(grid.active());
  for (std::size_t a = 0; a < grid.active(); ++a) {
    if (block_start_[a] < 0) continue;
    for (int k = 0; k < Block<Dim>::neighbours; ++k) {
      const int other = grid.active_beside(a, k);
      around_[a][k] = other >= 0 && block_start_[static_cast<std::size_t>(other)] >= 0 ? other : -1;
    }
  }
}

template class ContactNodes<2>;
template class ContactNodes<3>;

}  // namespace tailrun::mpm

#include "mpm_stage/boundary/contact_nodes.hpp"

#include <cmath>

namespace tailrun::mpm {

template <int Dim>
void ContactNodes<Dim>::update(const BlockGrid<Dim>& grid) {
  if (terrain_.empty()) return;
  constexpr int B = Block<Dim>::cells;
  const double h = grid.cell_size();
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
      if (terrain_.distance(x0 + half, y0 + half) < reach_ + 1.4143 * half) {
        std::vector<NodeContact> nodes(Block<Dim>::nodes);
        bool any = false;
        for (int n = 0; n < Block<Dim>::nodes; ++n) {
          const int i = n % B, j = n / B % B;
          nodes[n].count = terrain_.contacts(x0 + i * h, y0 + j * h, reach_, nodes[n].point, nodes[n].adhere);
          any = any || nodes[n].count > 0;
        }
        if (any) {
          it->second = static_cast<std::ptrdiff_t>(contacts_.size());
          contacts_.insert(contacts_.end(), nodes.begin(), nodes.end());
        }
      }
    }
    block_start_[a] = it->second;
  }
}

template class ContactNodes<2>;
template class ContactNodes<3>;

}  // namespace tailrun::mpm

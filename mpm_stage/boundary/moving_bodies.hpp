// Rigid boxes that move as prescribed and take the grid's nodes inside them along: footings, plates, pistons. Material
// neither slides along them nor comes off. What the nodes lose is the soil's push on the body: the sum over the nodes
// of m (v - v_body), so the reaction is exact and needs neither stiffness nor mass of the body.
//
// The edges act where the last nodes lie that a body holds: an edge between two nodes is an edge at the inner one, so a
// footing's width is best a whole number of cells.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

template <int Dim>
struct MovingBody {
  std::string name;
  std::array<double, Dim> low{}, high{};          // m, at the start
  std::vector<double> time;                       // s, rising
  std::vector<std::array<double, Dim>> velocity;  // m/s at these times, linear between them, constant before and after

  std::array<double, Dim> velocity_at(double t) const {
    const auto next = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
    if (next == 0) return velocity.front();
    if (next == time.size()) return velocity.back();
    const double share = (t - time[next - 1]) / (time[next] - time[next - 1]);
    std::array<double, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = (1.0 - share) * velocity[next - 1][d] + share * velocity[next][d];
    return v;
  }
};

// Where a body has got to.
template <int Dim>
struct BodyState {
  std::array<double, Dim> displacement{};  // m
  std::array<double, Dim> impulse{};  // N s (per metre in plane strain), of the material on the body since the start
};

// action(k) for the nodes inside the box of `body`, moved by `state`: numbers in arrays by active blocks.
template <int Dim, class Action>
void for_each_node_inside(const BlockGrid<Dim>& grid, const MovingBody<Dim>& body, const BodyState<Dim>& state,
                          Action action) {
  constexpr int B = Block<Dim>::cells;
  const double h = grid.cell_size(), tolerance = 1e-9 * h;
  for (std::size_t a = 0; a < grid.active(); ++a) {
    bool apart = false;
    std::array<double, Dim> corner;
    for (int d = 0; d < Dim; ++d) {
      corner[d] = grid.origin()[d] + grid.active_index(a)[d] * B * h - state.displacement[d];
      apart = apart || corner[d] > body.high[d] + tolerance || corner[d] + (B - 1) * h < body.low[d] - tolerance;
    }
    if (apart) continue;
    for (int n = 0; n < Block<Dim>::nodes; ++n) {
      bool outside = false;
      for (int d = 0, k = n; d < Dim; ++d, k /= B) {
        const double x = corner[d] + k % B * h;
        outside = outside || x < body.low[d] - tolerance || x > body.high[d] + tolerance;
      }
      if (!outside) action(a * Block<Dim>::nodes + static_cast<std::size_t>(n));
    }
  }
}

}  // namespace tailrun::mpm

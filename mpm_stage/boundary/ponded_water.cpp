#include "mpm_stage/boundary/ponded_water.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/warnings.hpp"

namespace tailrun::mpm {

namespace {

constexpr double soil_share = 0.2;  // 1, of the cell around a node that soil fills at least; a corner has a quarter
constexpr std::int32_t out_of_reach = std::numeric_limits<std::int32_t>::max();

}  // namespace

double Pond::level_at(double t) const {
  const auto next = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  if (next == 0) return level.front();
  if (next == time.size()) return level.back();
  const double share = (t - time[next - 1]) / (time[next] - time[next - 1]);
  return (1.0 - share) * level[next - 1] + share * level[next];
}

template <int Dim>
void PondedWater<Dim>::set_time(double t) {
  for (std::size_t k = 0; k < ponds_.size(); ++k) states_[k].level = ponds_[k].level_at(t);
}

template <int Dim>
bool PondedWater<Dim>::moves(double t) const {
  for (std::size_t k = 0; k < ponds_.size(); ++k)
    if (ponds_[k].level_at(t) != states_[k].level) return true;
  return false;
}

template <int Dim>
bool PondedWater<Dim>::outdated(double cell_size) const {
  for (const PondState& s : states_)
    if (std::fabs(s.level - s.mapped_level) > 0.25 * cell_size) return true;
  return false;
}

template <int Dim>
std::vector<double> PondedWater<Dim>::levels() const {
  std::vector<double> levels;
  for (const PondState& s : states_) levels.push_back(s.level);
  return levels;
}

template <int Dim>
std::array<double, Dim> PondedWater<Dim>::place_of(const BlockGrid<Dim>& grid, std::size_t a, int n) const {
  const auto node = grid.node_index(a, n);
  std::array<double, Dim> x;
  for (int d = 0; d < Dim; ++d) x[d] = grid.origin()[d] + node[d] * grid.cell_size();
  return x;
}

template <int Dim>
bool PondedWater<Dim>::in_range(const Pond& pond, const std::array<double, Dim>& x) const {
  for (int d = 0; d < Dim; ++d)
    if (x[d] < pond.low[d] || x[d] > pond.high[d]) return false;
  return true;
}

template <int Dim>
void PondedWater<Dim>::connect(const BlockGrid<Dim>& grid) {
  beside_.resize(grid.active());
  for (std::size_t a = 0; a < grid.active(); ++a)
    for (int k = 0; k < Block<Dim>::neighbours; ++k) beside_[a][k] = grid.active_beside(a, k);
}

// Cells from the nearest node whose role is `source`, over the nodes that may be passed.
template <int Dim>
std::vector<std::int32_t> PondedWater<Dim>::cells_from(const std::vector<Role>& role, Role source) const {
  std::vector<std::int32_t> distance(role.size(), out_of_reach);
  std::vector<std::size_t> edge, next;
  for (std::size_t k = 0; k < role.size(); ++k)
    if (role[k] == source) {
      distance[k] = 0;
      edge.push_back(k);
    }
  for (std::int32_t steps = 1; !edge.empty(); ++steps, edge.swap(next)) {
    next.clear();
    for (const std::size_t k : edge)
      for (int d = 0; d < Dim; ++d)
        for (const int side : {-1, 1}) {
          std::array<int, Dim> step{};
          step[d] = side;
          const std::ptrdiff_t to =
              node_beside<Dim>(beside_[k / Block<Dim>::nodes], static_cast<int>(k % Block<Dim>::nodes), step);
          if (to < 0 || distance[static_cast<std::size_t>(to)] != out_of_reach ||
              role[static_cast<std::size_t>(to)] != Role::passed)
            continue;
          distance[static_cast<std::size_t>(to)] = steps;
          next.push_back(static_cast<std::size_t>(to));
        }
  }
  return distance;
}

// Over soil that has sunk below the level: empty space in the pond's range beside empty space outside of it.
template <int Dim>
void PondedWater<Dim>::look_for_leaks(const BlockGrid<Dim>& grid, std::size_t pond, const std::vector<Role>& role,
                                      double time) {
  if (states_[pond].escaped >= 0.0) return;
  for (std::size_t k = 0; k < role.size(); ++k) {
    if (role[k] != Role::water) continue;
    for (int d = 0; d < Dim; d += 2)
      for (const int side : {-1, 1}) {
        std::array<int, Dim> step{};
        step[d] = side;
        const std::ptrdiff_t to =
            node_beside<Dim>(beside_[k / Block<Dim>::nodes], static_cast<int>(k % Block<Dim>::nodes), step);
        if (to < 0 || role[static_cast<std::size_t>(to)] != Role::dry) continue;
        const auto x = place_of(grid, k / Block<Dim>::nodes, static_cast<int>(k % Block<Dim>::nodes));
        states_[pond].escaped = time;
        std::copy(x.begin(), x.end(), states_[pond].place.begin());
        const std::string how =
            time > 0.0 ? fmt::format(
                             "at t = {:.3g} s soil at x = {:.4g} m has sunk below its level of {:.4g} m, so that "
                             "it runs over",
                             time, x[0], states_[pond].level)
                       : fmt::format(
                             "nothing holds it at x = {:.4g} m, where its range ends and its level of {:.4g} m "
                             "does not (ponded_water in mpm.json: x_from, x_to)",
                             x[0], states_[pond].level);
        add_warning(
            fmt::format("ponded water '{}': {}. What water that leaves does is not computed: it goes on pressing "
                        "inside its range as if it stood there",
                        ponds_[pond].name, how));
        return;
      }
  }
}

// Nodes that soil has, by how much of the cell around each it fills.
template <int Dim>
void PondedWater<Dim>::pass_soil(const BlockGrid<Dim>& grid, const Particles<Dim>& P,
                                 std::vector<std::uint8_t>& passed) const {
  constexpr int B = Block<Dim>::cells;
  const double h1 = 1.0 / grid.cell_size(), per_cell = std::pow(h1, Dim);
  std::vector<double> filled(passed.size(), 0.0);
  for (std::size_t b = 0; b < grid.occupied(); ++b)
    for (std::size_t p = grid.first_particle(b); p < grid.last_particle(b); ++p) {
      std::size_t block = 0, node = 0;
      for (int d = 0, three = 1, stride = 1; d < Dim; ++d, three *= 3, stride *= B) {
        const double X = (P.position[d][p] - grid.origin()[d]) * h1 - grid.occupied_index(b)[d] * B;
        const int i = static_cast<int>(std::floor(X + 0.5)) + B;  // counted from the block before
        block += static_cast<std::size_t>(i / B * three);
        node += static_cast<std::size_t>(i % B * stride);
      }
      const auto a = static_cast<std::size_t>(grid.active_around(b)[block]);
      filled[a * Block<Dim>::nodes + node] += P.volume[p] * per_cell;
    }
  for (std::size_t k = 0; k < passed.size(); ++k)
    if (filled[k] >= soil_share) passed[k] = 1;
}

template <int Dim>
void PondedWater<Dim>::map(const BlockGrid<Dim>& grid, const std::vector<std::uint8_t>& passed, double time) {
  connect(grid);
  shares_.resize(ponds_.size() * passed.size());
  std::vector<Role> role(passed.size());
  for (std::size_t pond = 0; pond < ponds_.size(); ++pond) {
    double* W = shares_.data() + pond * passed.size();
    for (std::size_t k = 0; k < passed.size(); ++k) {
      const auto x = place_of(grid, k / Block<Dim>::nodes, static_cast<int>(k % Block<Dim>::nodes));
      const bool here = in_range(ponds_[pond], x);
      W[k] = here ? 1.0 : 0.0;
      role[k] = passed[k] ? Role::passed : x[1] >= states_[pond].level ? Role::air : here ? Role::water : Role::dry;
    }
    const auto wet = cells_from(role, Role::water), dry = cells_from(role, Role::dry);
    for (std::size_t k = 0; k < passed.size(); ++k) {
      if (role[k] != Role::passed) continue;
      if (wet[k] == out_of_reach)
        W[k] = 0.0;
      else if (dry[k] == out_of_reach)
        W[k] = 1.0;
      else
        W[k] = std::clamp(3.0 * dry[k] / (static_cast<double>(wet[k]) + dry[k]) - 1.0, 0.0, 1.0);
    }
    look_for_leaks(grid, pond, role, time);
    states_[pond].mapped_level = states_[pond].level;
  }
  find_wet_blocks(grid);
}

template <int Dim>
void PondedWater<Dim>::find_wet_blocks(const BlockGrid<Dim>& grid) {
  wet_.assign(ponds_.size() * grid.occupied(), 0);
  for (std::size_t k = 0; k < ponds_.size(); ++k) {
    const double* W = shares_.data() + k * grid.active() * Block<Dim>::nodes;
    for (std::size_t b = 0; b < grid.occupied(); ++b)
      for (const int a : grid.active_around(b)) {
        const double* first = W + static_cast<std::size_t>(a) * Block<Dim>::nodes;
        if (std::any_of(first, first + Block<Dim>::nodes, [](double w) { return w > 0.0; }))
          wet_[k * grid.occupied() + b] = 1;
      }
  }
}

template <int Dim>
void PondedWater<Dim>::restore(const BlockGrid<Dim>& grid, std::vector<double> shares, std::vector<PondState> states) {
  shares_ = std::move(shares);
  states_ = std::move(states);
  find_wet_blocks(grid);
}

template class PondedWater<2>;
template class PondedWater<3>;

}  // namespace tailrun::mpm

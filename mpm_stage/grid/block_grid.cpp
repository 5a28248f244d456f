#include "mpm_stage/grid/block_grid.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "common/error.hpp"

namespace tailrun::mpm {

namespace {

constexpr int key_bits = 21;
constexpr std::int64_t key_offset = std::int64_t{1} << (key_bits - 1);

// Blocks sort row by row: z slowest, x fastest.
template <int Dim>
std::uint64_t block_key(const std::array<int, Dim>& index) {
  std::uint64_t key = 0;
  for (int d = Dim - 1; d >= 0; --d) key = (key << key_bits) | static_cast<std::uint64_t>(index[d] + key_offset);
  return key;
}

template <int Dim>
std::array<int, Dim> block_of_key(std::uint64_t key) {
  std::array<int, Dim> index;
  for (int d = 0; d < Dim; ++d) {
    index[d] = static_cast<int>(static_cast<std::int64_t>(key & ((std::uint64_t{1} << key_bits) - 1)) - key_offset);
    key >>= key_bits;
  }
  return index;
}

template <int Dim>
std::array<int, Dim> neighbour(std::array<int, Dim> index, int n) {
  for (int d = 0; d < Dim; ++d, n /= 3) index[d] += n % 3 - 1;
  return index;
}

int rank_of(const std::vector<std::uint64_t>& keys, std::uint64_t key) {
  const auto it = std::lower_bound(keys.begin(), keys.end(), key);
  return it != keys.end() && *it == key ? static_cast<int>(it - keys.begin()) : -1;
}

template <class Column, class Spare>
void permute(Column& column, Spare& spare, const std::vector<std::uint32_t>& order) {
  if (column.empty()) return;
  spare.resize(order.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < order.size(); ++i) spare[i] = column[order[i]];
  column.swap(spare);
}

}  // namespace

template <int Dim>
BlockGrid<Dim>::BlockGrid(double cell_size, std::array<double, Dim> origin, double shift)
    : cell_size_(cell_size), shift_(shift), origin_(origin) {}

template <int Dim>
void BlockGrid<Dim>::sort(Particles<Dim>& particles, std::span<const std::uint8_t> keep, const FieldChoice& fields) {
  const std::size_t n = particles.count();
  const double inverse = 1.0 / cell_size_;

  // Key of each particle's block; keys repeat from one particle to the next, so the map is asked seldom.
  std::unordered_map<std::uint64_t, std::uint32_t> number_of_key;
  std::vector<std::uint64_t> keys;
  rank_.resize(n);
  std::uint64_t last_key = ~std::uint64_t{0};
  std::uint32_t last_number = 0;
  int materials = 1;
  for (std::size_t p = 0; p < n; ++p) {
    std::array<int, Dim> index;
    for (int d = 0; d < Dim; ++d) {
      const double block = std::floor(((particles.position[d][p] - origin_[d]) * inverse + shift_) / Block<Dim>::cells);
      if (!(std::fabs(block) < static_cast<double>(key_offset - 2)))
        throw ComputationError(fmt::format("particle {} has left the range of the grid: coordinate {} is {} m",
                                           particles.identity[p], d, particles.position[d][p]));
      index[d] = static_cast<int>(block);
    }
    const std::uint64_t key = block_key<Dim>(index);
    if (key != last_key) {
      const auto [it, is_new] = number_of_key.try_emplace(key, static_cast<std::uint32_t>(keys.size()));
      if (is_new) keys.push_back(key);
      last_key = key;
      last_number = it->second;
    }
    rank_[p] = last_number;
    materials = std::max(materials, particles.material[p] + 1);
  }

  // Counting sort by (block in row order, field, material); stable, so the previous order decides inside a run.
  const int groups = fields.count * materials;
  std::vector<std::uint64_t> sorted = keys;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> rank_of_number(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k)
    rank_of_number[k] = static_cast<std::uint32_t>(rank_of(sorted, keys[k]));
  std::vector<std::size_t> start(sorted.size() * groups + 1, 0);
  std::size_t kept = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const int group =
        fields.several() ? fields.of(particles, p) * materials + particles.material[p] : particles.material[p];
    rank_[p] = rank_of_number[rank_[p]] * groups + group;
    if (!keep.empty() && !keep[p]) continue;
    ++start[rank_[p] + 1];
    ++kept;
  }
  for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
  const std::vector<std::size_t> bounds = start;
  order_.resize(kept);
  for (std::size_t p = 0; p < n; ++p)
    if (keep.empty() || keep[p]) order_[start[rank_[p]]++] = static_cast<std::uint32_t>(p);

  particles.for_each_column([this](auto& column) { permute(column, spare_, order_); });
  permute(particles.material, spare_integers_, order_);
  permute(particles.identity, spare_integers_, order_);
  permute(particles.side, spare_integers_, order_);

  // Runs and occupied blocks; a block that only dropped particles were in does not exist.
  occupied_index_.clear();
  first_.clear();
  first_run_.clear();
  runs_.clear();
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (bounds[k * groups] == bounds[(k + 1) * groups]) continue;
    occupied_index_.push_back(block_of_key<Dim>(sorted[k]));
    first_.push_back(bounds[k * groups]);
    first_run_.push_back(runs_.size());
    for (int g = 0; g < groups; ++g) {
      const std::size_t begin = bounds[k * groups + g], end = bounds[k * groups + g + 1];
      if (begin < end) runs_.push_back({begin, end, g % materials, g / materials});
    }
  }
  first_.push_back(kept);
  first_run_.push_back(runs_.size());
  connect();
}

template <int Dim>
void BlockGrid<Dim>::restore(const std::vector<Index>& occupied, const std::vector<std::size_t>& first,
                             const Particles<Dim>& particles, const FieldChoice& fields) {
  occupied_index_ = occupied;
  first_ = first;
  first_run_.clear();
  runs_.clear();
  for (std::size_t b = 0; b < occupied.size(); ++b) {
    first_run_.push_back(runs_.size());
    for (std::size_t p = first[b]; p < first[b + 1]; ++p) {
      const int material = particles.material[p], field = fields.of(particles, p);
      if (p == first[b] || material != runs_.back().material || field != runs_.back().field)
        runs_.push_back({p, p, material, field});
      runs_.back().end = p + 1;
    }
  }
  first_run_.push_back(runs_.size());
  connect();
}

template <int Dim>
void BlockGrid<Dim>::connect() {
  std::vector<std::uint64_t> occupied_keys;
  for (const auto& index : occupied_index_) occupied_keys.push_back(block_key<Dim>(index));
  std::vector<std::uint64_t>& active_keys = active_keys_;
  active_keys.clear();
  active_keys.reserve(occupied_keys.size() * 2);
  for (const auto& index : occupied_index_)
    for (int k = 0; k < Block<Dim>::neighbours; ++k) active_keys.push_back(block_key<Dim>(neighbour<Dim>(index, k)));
  std::sort(active_keys.begin(), active_keys.end());
  active_keys.erase(std::unique(active_keys.begin(), active_keys.end()), active_keys.end());
  active_index_.resize(active_keys.size());
  tiles_around_.resize(active_keys.size());
  active_around_.resize(occupied_keys.size());
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < active_keys.size(); ++a) {
    active_index_[a] = block_of_key<Dim>(active_keys[a]);
    for (int k = 0; k < Block<Dim>::neighbours; ++k)
      tiles_around_[a][k] = rank_of(occupied_keys, block_key<Dim>(neighbour<Dim>(active_index_[a], k)));
  }
#pragma omp parallel for schedule(static)
  for (std::size_t b = 0; b < occupied_keys.size(); ++b)
    for (int k = 0; k < Block<Dim>::neighbours; ++k)
      active_around_[b][k] = rank_of(active_keys, block_key<Dim>(neighbour<Dim>(occupied_index_[b], k)));
}

template <int Dim>
int BlockGrid<Dim>::active_beside(std::size_t a, int k) const {
  return rank_of(active_keys_, block_key<Dim>(neighbour<Dim>(active_index_[a], k)));
}

template <int Dim>
std::size_t BlockGrid<Dim>::bytes() const {
  return active() * (sizeof(Index) + sizeof(tiles_around_[0])) +
         occupied() * (sizeof(Index) + sizeof(active_around_[0]) + 2 * sizeof(std::size_t)) +
         runs_.size() * sizeof(Run) + (order_.capacity() + rank_.capacity()) * sizeof(std::uint32_t) +
         spare_.capacity() * sizeof(double) + spare_integers_.capacity() * sizeof(std::int32_t);
}

template class BlockGrid<2>;
template class BlockGrid<3>;

}  // namespace tailrun::mpm

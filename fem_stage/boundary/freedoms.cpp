#include "fem_stage/boundary/freedoms.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

// Every one of the nodes, sorted by height, has another at its height: a node that is left alone would stay loose in
// silence, though it lies only a centimetre off.
void require_partners(const Mesh& mesh, const std::vector<std::int64_t>& sorted, double tolerance,
                      const std::string& where) {
  const auto x = [&](std::size_t i) { return mesh.x(static_cast<std::size_t>(sorted[i])); };
  const auto y = [&](std::size_t i) { return mesh.y(static_cast<std::size_t>(sorted[i])); };
  std::string places;
  std::size_t alone = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t j = i + 1;
    while (j < sorted.size() && y(j) - y(i) <= tolerance) ++j;
    if (j == i + 1) {
      double gap = std::numeric_limits<double>::infinity();
      if (i > 0) gap = std::min(gap, y(i) - y(i - 1));
      if (j < sorted.size()) gap = std::min(gap, y(j) - y(i));
      nearest = std::min(nearest, gap);
      if (++alone <= 5) places += fmt::format("{}({:.6g}, {:.6g})", places.empty() ? "" : ", ", x(i), y(i));
    }
    i = j;
  }
  if (alone > 0)
    throw InputError(
        fmt::format("{}: {} of {} nodes have no partner at the same height (within {:.2g} m): {}{}{}; nodes are "
                    "tied by their height, so the two sides need the same ones",
                    where, alone, sorted.size(), tolerance, places, alone > 5 ? ", ..." : "",
                    std::isfinite(nearest) ? fmt::format("; the smallest difference is {:.3g} m", nearest) : ""));
}

}  // namespace

Freedoms::Freedoms(std::size_t nodes) : parent_(3 * nodes), fixed_(3 * nodes, 0) {
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
}

std::size_t Freedoms::root(std::size_t freedom) const {
  while (parent_[freedom] != freedom) freedom = parent_[freedom];
  return freedom;
}

void Freedoms::fix(std::int64_t node, Freedom freedom) {
  fixed_[root(3 * static_cast<std::size_t>(node) + freedom)] = 1;
}

void Freedoms::tie(std::int64_t a, std::int64_t b, Freedom freedom) {
  const std::size_t ra = root(3 * static_cast<std::size_t>(a) + freedom),
                    rb = root(3 * static_cast<std::size_t>(b) + freedom);
  if (ra == rb) return;
  const std::size_t low = std::min(ra, rb), high = std::max(ra, rb);
  parent_[high] = low;
  fixed_[low] = static_cast<char>(fixed_[low] | fixed_[high]);
}

bool Freedoms::fixed(std::size_t node, Freedom freedom) const {
  return fixed_[root(3 * node + freedom)] != 0;
}

Freedoms::Equations Freedoms::number(bool displacement, bool pressure) const {
  Equations equations;
  equations.number.assign(parent_.size(), -1);
  for (std::size_t freedom = 0; freedom < parent_.size(); ++freedom) {
    const bool wanted = freedom % 3 == freedom_p ? pressure : displacement;
    const std::size_t r = root(freedom);
    if (!wanted || fixed_[r]) continue;
    if (r == freedom)
      equations.number[freedom] = equations.count++;
    else
      equations.number[freedom] = equations.number[r];  // a root is the smallest of its set: already numbered
  }
  return equations;
}

std::string Freedoms::Equations::describe(int equation, const Mesh& mesh) const {
  static const char* names[3] = {"u_x", "u_y", "pore pressure"};
  for (std::size_t freedom = 0; freedom < number.size(); ++freedom)
    if (number[freedom] == equation)
      return fmt::format("{} of node {} at ({:.4g}, {:.4g})", names[freedom % 3], freedom / 3, mesh.x(freedom / 3),
                         mesh.y(freedom / 3));
  return "an unknown freedom";
}

void tie_equal_heights(Freedoms& freedoms, const Mesh& mesh, std::span<const std::int64_t> nodes, double tolerance,
                       std::span<const Freedom> which, const std::string& where) {
  std::vector<std::int64_t> sorted(nodes.begin(), nodes.end());
  const auto height = [&](std::int64_t node) { return mesh.y(static_cast<std::size_t>(node)); };
  std::stable_sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return height(a) < height(b); });
  require_partners(mesh, sorted, tolerance, where);
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t j = i + 1;
    for (; j < sorted.size() && std::abs(height(sorted[j]) - height(sorted[i])) <= tolerance; ++j)
      for (const Freedom freedom : which) freedoms.tie(sorted[i], sorted[j], freedom);
    i = j;
  }
}

}  // namespace tailrun::fem

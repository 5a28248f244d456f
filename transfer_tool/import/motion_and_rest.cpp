#include "transfer_tool/import/motion_and_rest.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/plausible_state.hpp"

namespace tailrun::transfer {
namespace {

constexpr double least_share = 0.05;                          // of the mean vertical stress, to be counted
constexpr double half = 0.5, tenth = 0.1;                     // 1
constexpr double least_ratio = 0.1, most_ratio = 5.0;         // of horizontal to vertical stress
constexpr double impossible_ratio = 50.0;                     // 1
constexpr double fastest_slide = 100.0, impossible = 1000.0;  // m/s
constexpr double fast = 5.0;                                  // m/s
constexpr double fastest_swing = 300.0;                       // 1/s, velocity over displacement
constexpr double after = 1.0;                                 // s, until displacements have grown

// Compression positive, Pa, of the state before the shaking.
double horizontal(const Snapshot& s, std::size_t e) {
  return -s.initial_effective_stress[4 * e];
}
double vertical(const Snapshot& s, std::size_t e) {
  return -s.initial_effective_stress[4 * e + 1];
}

struct AtRest {
  std::size_t count = 0, tensions = 0, first = 0;
  double horizontal = 0.0, vertical = 0.0;  // Pa, sums
};

AtRest at_rest(const Snapshot& s) {
  double mean = 0.0;
  for (std::size_t e = 0; e < s.elements(); ++e) mean += vertical(s, e) / static_cast<double>(s.elements());
  AtRest sum;
  for (std::size_t e = 0; e < s.elements(); ++e) {
    if (vertical(s, e) <= least_share * std::abs(mean)) continue;
    ++sum.count;
    sum.horizontal += horizontal(s, e);
    sum.vertical += vertical(s, e);
    if (horizontal(s, e) < 0.0 && sum.tensions++ == 0) sum.first = e;
  }
  return sum;
}

std::array<double, 2> centre_of(const Snapshot& s, std::size_t e) {
  std::array<double, 2> centre{};
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t k = 0; k < 2; ++k)
      centre[k] += 0.25 * s.position[2 * static_cast<std::size_t>(s.quads[4 * e + a]) + k];
  return centre;
}

void check_exchanged(const CaseNode& root, const std::string& key, const Snapshot& s, const AtRest& rest) {
  constexpr double more = 1.3, less = 0.8, dry = 0.2;  // 1
  const StateColumns columns = columns_of(s, "", {}, true);
  double left = 0.0, weight = 0.0, sum_x = 0.0, sum_y = 0.0;
  for (std::size_t e = 0; e < s.elements(); ++e) {
    left += columns.weight_above[e] - columns.pore_pressure[e];
    weight += columns.weight_above[e];
    sum_x += horizontal(s, e);
    sum_y += vertical(s, e);
  }
  if (rest.count == 0 || left < dry * weight || sum_x <= 0.0 || sum_y <= 0.0) return;
  if (sum_x > more * sum_y && sum_y < less * left &&
      std::abs(std::log(sum_x / left)) < std::abs(std::log(sum_y / left)))
    root.warn(key,
              fmt::format("sxx is {:.3g} times syy, and {:.3g} times what the weight above leaves beside the pore "
                          "pressure, of which syy is {:.3g} (sums over {} elements); are the two columns exchanged?",
                          sum_x / sum_y, sum_x / left, sum_y / left, s.elements()));
}

void check_horizontal(const CaseNode& root, const Snapshot& s) {
  const std::string key = root.has("initial_element_state") ? "initial_element_state" : "element_state";
  const AtRest rest = at_rest(s);
  if (rest.count == 0 || !(rest.vertical > 0.0)) return;
  const double ratio = rest.horizontal / rest.vertical;
  if (static_cast<double>(rest.tensions) > half * static_cast<double>(rest.count)) {
    const auto [x, y] = centre_of(s, rest.first);
    const std::string found = fmt::format(
        "sxx is a tension in {} of {} elements whose syy is a compression, the first at ({:.4g}, {:.4g}) m, in sum "
        "{:.3g} "
        "times syy, but soil at rest has 0.3 to 1 times",
        rest.tensions, rest.count, x, y, ratio);
    if (ratio < -tenth) root.fail(key, found + "; most likely the sign of the column sxx");
    return root.warn(key, found + "; is the sign of sxx right?");
  }
  const std::string found = fmt::format(
      "sxx is {:.3g} times syy (sums over {} elements before the shaking), but soil at rest has 0.3 to 1 "
      "times, stiff clay up to 3",
      ratio, rest.count);
  if (ratio > impossible_ratio) root.fail(key, found + "; most likely the two columns have different units");
  if (ratio > most_ratio || ratio < least_ratio)
    return root.warn(key, found + "; do the two columns have the same unit and sign?");
  check_exchanged(root, key, s, rest);
}

// The largest of a nodal vector, and where.
struct Largest {
  double size = 0.0, x = 0.0, y = 0.0;
};

Largest largest_of(const Snapshot& s, const std::vector<double>& values) {
  Largest most;
  for (std::size_t n = 0; n < s.nodes(); ++n)
    if (const double size = std::hypot(values[2 * n], values[2 * n + 1]); size > most.size)
      most = {size, s.position[2 * n], s.position[2 * n + 1]};
  return most;
}

std::string likely(const char* quantity, double size, const char* per_second) {
  return fmt::format("; {0} are in m{1}: {2:.4g} mm{1} are {3:.4g} m{1}", quantity, per_second, size, 1e-3 * size);
}

void check_motion(const CaseNode& root, const Snapshot& s) {
  const Largest fastest = largest_of(s, s.velocity), farthest = largest_of(s, s.displacement);
  const std::string at =
      fmt::format("nodes move with up to {:.4g} m/s, at ({:.4g}, {:.4g}) m", fastest.size, fastest.x, fastest.y);
  if (fastest.size > impossible)
    root.fail("node_state", fmt::format("{}, but at most {:g} m/s are allowed{}", at, impossible,
                                        likely("vx and vy", fastest.size, "/s")));
  if (fastest.size > fastest_slide)
    root.warn("node_state", fmt::format("{}, which no slide does{}", at, likely("vx and vy", fastest.size, "/s")));
  else if (fastest.size > fast && s.time > after && farthest.size > 0.0 && fastest.size > fastest_swing * farthest.size)
    root.warn("node_state",
              fmt::format("{}, but none is farther than {:.3g} m from where it was before the shaking, {:g} "
                          "s ago{}",
                          at, farthest.size, s.time, likely("vx and vy", fastest.size, "/s")));

  double low[2] = {s.position[0], s.position[1]}, high[2] = {low[0], low[1]};
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    low[i % 2] = std::min(low[i % 2], s.position[i]);
    high[i % 2] = std::max(high[i % 2], s.position[i]);
  }
  const double height = high[1] - low[1], diagonal = std::hypot(high[0] - low[0], height);
  const std::string moved =
      fmt::format("nodes have moved by up to {:.4g} m, at ({:.4g}, {:.4g}) m", farthest.size, farthest.x, farthest.y);
  if (farthest.size > diagonal)
    root.fail("node_state",
              fmt::format("{}, but the whole mesh is {:.4g} m from corner to corner, and no more is allowed{}", moved,
                          diagonal, likely("ux and uy", farthest.size, "")));
  if (farthest.size > half * height)
    root.warn("node_state",
              fmt::format("{}, in a mesh {:.4g} m high{}", moved, height, likely("ux and uy", farthest.size, "")));
}

}  // namespace

void check_rest_and_motion(const CaseNode& root, const Snapshot& snapshot) {
  check_horizontal(root, snapshot);
  check_motion(root, snapshot);
}

}  // namespace tailrun::transfer

#include "fem_stage/boundary/phreatic_line.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace tailrun::fem {

double phreatic_elevation(const std::vector<double>& line, double x) {
  const std::size_t rows = line.size() / 2;
  if (x <= line[0]) return line[1];
  for (std::size_t i = 1; i < rows; ++i) {
    if (x > line[2 * i]) continue;
    const double s = (x - line[2 * i - 2]) / (line[2 * i] - line[2 * i - 2]);
    return line[2 * i - 1] + s * (line[2 * i + 1] - line[2 * i - 1]);
  }
  return line[2 * rows - 1];
}

std::vector<char> on_or_above_phreatic_line(const Mesh& mesh, const std::vector<double>& line) {
  std::vector<char> above(mesh.nodes(), 1);
  if (line.empty()) return above;
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    const double level = phreatic_elevation(line, mesh.x(n));
    above[n] = mesh.y(n) >= level - 1e-6 * (1.0 + std::abs(level));
  }
  return above;
}

int snap_to_phreatic_line(Mesh& mesh, const std::vector<double>& line, double distance) {
  std::set<std::int64_t> pinned;  // named lines and region interfaces keep their shape
  for (const auto& [name, edges] : mesh.lines)
    for (const auto& edge : edges) pinned.insert(edge.begin(), edge.end());
  std::vector<std::set<int>> regions(mesh.nodes());
  std::vector<std::vector<std::size_t>> elements(mesh.nodes());
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    const auto node = static_cast<std::size_t>(mesh.quads[i]);
    regions[node].insert(mesh.region[i / 4]);
    elements[node].push_back(i / 4);
  }
  const auto worst = [&](std::size_t node) {
    double value = 1.0;
    for (const std::size_t e : elements[node]) {
      double corners[8];
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t i = 0; i < 2; ++i)
          corners[2 * a + i] = mesh.position[2 * static_cast<std::size_t>(mesh.quads[4 * e + a]) + i];
      value = std::min(value, scaled_jacobian(corners));
    }
    return value;
  };
  int moved = 0;
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    const double level = phreatic_elevation(line, mesh.x(n)), before = mesh.y(n);
    if (before == level || std::abs(before - level) > distance || regions[n].size() > 1 ||
        pinned.contains(static_cast<std::int64_t>(n)))
      continue;
    const double quality = worst(n);
    mesh.position[2 * n + 1] = level;
    if (worst(n) < std::min(0.3, quality))
      mesh.position[2 * n + 1] = before;
    else
      ++moved;
  }
  return moved;
}

}  // namespace tailrun::fem

// Terrain lines that lie on each other. A node takes two contacts at most (Terrain::contacts): with the same ground
// twice none is left for a corner, and of two frictions it is not told which one holds.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mpm_stage/scene/scene_checks.hpp"

namespace tailrun::mpm {

namespace {

using Point = std::array<double, 2>;

constexpr double on_each_other = 1e-3;  // cells, off the other line
constexpr double much = 0.5;            // of the shorter line's length

double length_of(const TerrainInput& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.points.size(); ++i)
    length += std::hypot(line.points[i][0] - line.points[i - 1][0], line.points[i][1] - line.points[i - 1][1]);
  return length;
}

// m, of the segment c-d along which it lies on a-b and goes the same way; 0 otherwise.
double common_length(const Point& a, const Point& b, const Point& c, const Point& d, double near) {
  for (std::size_t k = 0; k < 2; ++k)
    if (std::max(c[k], d[k]) < std::min(a[k], b[k]) - near || std::min(c[k], d[k]) > std::max(a[k], b[k]) + near)
      return 0.0;
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]), tx = (b[0] - a[0]) / length, ty = (b[1] - a[1]) / length;
  const auto off = [&](const Point& p) { return std::fabs(tx * (p[1] - a[1]) - ty * (p[0] - a[0])); };
  const auto along = [&](const Point& p) { return tx * (p[0] - a[0]) + ty * (p[1] - a[1]); };
  if (off(c) > near || off(d) > near) return 0.0;
  return std::max(0.0, std::min(length, along(d)) - std::max(0.0, along(c)));  // below 0 where it goes the other way
}

struct Common {
  double length = 0.0;  // m
  bool differs = false;
};

// Segments of `line` from left to right, so that those beside a place are found without asking all.
class ByPlace {
 public:
  explicit ByPlace(const TerrainInput& line) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const double a = line.points[i - 1][0], b = line.points[i][0];
      left_.emplace_back(std::min(a, b), i);
      widest_ = std::max(widest_, std::fabs(b - a));
    }
    std::sort(left_.begin(), left_.end());
  }
  // action(number of the segment's end) for all that reach into low .. high.
  template <class Action>
  void within(double low, double high, Action action) const {
    for (auto at = std::lower_bound(left_.begin(), left_.end(), std::pair{low - widest_, std::size_t{0}});
         at != left_.end() && at->first <= high; ++at)
      action(at->second);
  }

 private:
  std::vector<std::pair<double, std::size_t>> left_;  // m; number
  double widest_ = 0.0;                               // m
};

Common common_of(const TerrainInput& one, const TerrainInput& other, double near) {
  Common common;
  const ByPlace others(other);
  for (std::size_t i = 1; i < one.points.size(); ++i) {
    const double a = one.points[i - 1][0], b = one.points[i][0];
    others.within(std::min(a, b) - near, std::max(a, b) + near, [&](std::size_t j) {
      const double length = common_length(one.points[i - 1], one.points[i], other.points[j - 1], other.points[j], near);
      if (length <= near) return;
      common.length += length;
      common.differs = common.differs || one.adhere != other.adhere || one.friction[i - 1] != other.friction[j - 1];
    });
  }
  return common;
}

}  // namespace

void check_doubled_ground(const CaseNode& root, const Scene& scene) {
  const auto& lines = scene.terrain_lines;
  for (std::size_t l = 0; l < lines.size(); ++l)
    for (std::size_t o = 0; o < l; ++o) {
      const Common common = common_of(lines[o], lines[l], on_each_other * scene.cell_size);
      if (common.length < much * std::min(length_of(lines[o]), length_of(lines[l]))) continue;
      const std::string key = fmt::format("terrain/{}", l);
      const std::string found = fmt::format("line '{}' lies on line '{}' (/terrain/{}) over {:.4g} m", lines[l].name,
                                            lines[o].name, o, common.length);
      if (common.differs)
        root.fail(key, found +
                           " with another friction or 'adhere', so that it is not told which one holds; one of the "
                           "two has to go");
      root.warn(key,
                found + ": the same ground twice; one of the two has to go, for corners are held by one line alone");
    }
}

}  // namespace tailrun::mpm

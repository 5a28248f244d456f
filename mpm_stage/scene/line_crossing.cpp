#include "mpm_stage/scene/line_crossing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tailrun::mpm {
namespace {

using Point = std::array<double, 2>;
using Points = std::vector<Point>;

// Twice the area of the triangle, positive when c lies left of a -> b.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool in_box(const Point& p, const Point& a, const Point& b) {
  return p[0] >= std::min(a[0], b[0]) && p[0] <= std::max(a[0], b[0]) && p[1] >= std::min(a[1], b[1]) &&
         p[1] <= std::max(a[1], b[1]);
}

std::optional<Point> common_point(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double c_side = turn(a, b, c), d_side = turn(a, b, d), a_side = turn(c, d, a), b_side = turn(c, d, b);
  const auto differ = [](double one, double other) { return (one > 0.0 && other < 0.0) || (one < 0.0 && other > 0.0); };
  if (differ(c_side, d_side) && differ(a_side, b_side)) {
    const double s = c_side / (c_side - d_side);
    return Point{c[0] + s * (d[0] - c[0]), c[1] + s * (d[1] - c[1])};
  }
  if (c_side == 0.0 && in_box(c, a, b)) return c;
  if (d_side == 0.0 && in_box(d, a, b)) return d;
  if (a_side == 0.0 && in_box(a, c, d)) return a;
  if (b_side == 0.0 && in_box(b, c, d)) return b;
  return std::nullopt;
}

bool goes_one_way(const Points& points, std::size_t axis) {
  bool up = true, down = true;
  for (std::size_t i = 1; i < points.size(); ++i) {
    up &= points[i][axis] > points[i - 1][axis];
    down &= points[i][axis] < points[i - 1][axis];
  }
  return up || down;
}

// Two segments of the line, i < j.
std::optional<LineCrossing> crossing_of(const Points& points, std::size_t i, std::size_t j) {
  const Point &a = points[i], &b = points[i + 1], &c = points[j], &d = points[j + 1];
  if (j == i + 1) {  // neighbours share b; beyond it only when the line turns back on itself
    const bool back = turn(a, b, d) == 0.0 && (b[0] - a[0]) * (d[0] - b[0]) + (b[1] - a[1]) * (d[1] - b[1]) < 0.0;
    return back ? std::optional(LineCrossing{i, j, b}) : std::nullopt;
  }
  const auto place = common_point(a, b, c, d);
  if (!place) return std::nullopt;
  if (i == 0 && j + 2 == points.size() && a == d &&
      *place == a) {  // a ring closes, unless it comes back along its start
    const bool along = turn(a, b, c) == 0.0 && (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]) > 0.0;
    if (!along) return std::nullopt;
  }
  return LineCrossing{i, j, *place};
}

}  // namespace

std::optional<LineCrossing> first_crossing(const Points& points) {
  if (points.size() < 3 || goes_one_way(points, 0) || goes_one_way(points, 1)) return std::nullopt;
  Point low = points[0], high = points[0];
  for (const Point& p : points)
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  // Segments in the order in which a sweep along the longer side meets them; only those it is still in can be crossed.
  const std::size_t axis = high[0] - low[0] >= high[1] - low[1] ? 0 : 1;
  const auto from = [&](std::size_t s) { return std::min(points[s][axis], points[s + 1][axis]); };
  const auto to = [&](std::size_t s) { return std::max(points[s][axis], points[s + 1][axis]); };
  std::vector<std::size_t> order(points.size() - 1), open;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t s, std::size_t t) { return from(s) < from(t); });
  for (const std::size_t s : order) {
    std::erase_if(open, [&](std::size_t other) { return to(other) < from(s); });
    for (const std::size_t other : open)
      if (const auto found = crossing_of(points, std::min(s, other), std::max(s, other))) return found;
    open.push_back(s);
  }
  return std::nullopt;
}

}  // namespace tailrun::mpm

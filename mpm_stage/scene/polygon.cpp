#include "mpm_stage/scene/polygon.hpp"

#include <cmath>

namespace tailrun::mpm {

namespace {

using Point = std::array<double, 2>;

Point corner(const std::vector<double>& polygon, std::size_t i) {
  const std::size_t k = i % (polygon.size() / 2);
  return {polygon[2 * k], polygon[2 * k + 1]};
}

// Twice the area of a, b, c: > 0 where c lies on the left of a - b.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace

bool inside_polygon(const std::vector<double>& polygon, double x, double y) {
  bool inside = false;
  const std::size_t n = polygon.size() / 2;
  for (std::size_t i = 0, j = n - 1; i < n; j = i++) {
    const double xi = polygon[2 * i], yi = polygon[2 * i + 1], xj = polygon[2 * j], yj = polygon[2 * j + 1];
    if ((yi > y) != (yj > y) && x < (xj - xi) * (y - yi) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

double polygon_area(const std::vector<double>& polygon) {
  double twice = 0.0;
  // From the first corner, so that a polygon far from the origin loses no digits.
  for (std::size_t i = 1; i + 1 < polygon.size() / 2; ++i)
    twice += turn(corner(polygon, 0), corner(polygon, i), corner(polygon, i + 1));
  return 0.5 * std::fabs(twice);
}

double polygon_perimeter(const std::vector<double>& polygon) {
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size() / 2; ++i) {
    const Point a = corner(polygon, i), b = corner(polygon, i + 1);
    length += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  return length;
}

std::optional<PolygonCrossing> polygon_crossing(const std::vector<double>& polygon) {
  const std::size_t n = polygon.size() / 2;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Point a = corner(polygon, i), b = corner(polygon, i + 1), c = corner(polygon, j),
                  d = corner(polygon, j + 1);
      const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
      // What is nearer to a line than round-off of the corners' digits touches it.
      const double round_off = 1e-12 * ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                                        (d[0] - c[0]) * (d[0] - c[0]) + (d[1] - c[1]) * (d[1] - c[1]));
      const auto opposite = [&](double p, double q) {
        return (p > round_off && q < -round_off) || (p < -round_off && q > round_off);
      };
      if (!opposite(abc, abd) || !opposite(cda, cdb)) continue;
      const double t = abc / (abc - abd);
      return PolygonCrossing{i, j, {c[0] + t * (d[0] - c[0]), c[1] + t * (d[1] - c[1])}};
    }
  return std::nullopt;
}

}  // namespace tailrun::mpm

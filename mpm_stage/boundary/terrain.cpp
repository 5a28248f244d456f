#include "mpm_stage/boundary/terrain.hpp"

#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace tailrun::mpm {

namespace {

struct Foot {
  double along;    // share of the segment, before clamping
  double squared;  // squared distance to the (clamped) foot, m2
  double offset;   // signed distance to the segment's line, m
  std::array<double, 2> point, normal;
};

Foot foot_on(const Terrain::Segment& s, double x, double y, bool first, bool last) {
  const double tx = s.b[0] - s.a[0], ty = s.b[1] - s.a[1], length2 = tx * tx + ty * ty, length = std::sqrt(length2);
  Foot f;
  f.along = ((x - s.a[0]) * tx + (y - s.a[1]) * ty) / length2;
  double t = f.along;
  if (!first && t < 0.0) t = 0.0;
  if (!last && t > 1.0) t = 1.0;
  f.point = {s.a[0] + t * tx, s.a[1] + t * ty};
  f.squared = (x - f.point[0]) * (x - f.point[0]) + (y - f.point[1]) * (y - f.point[1]);
  f.normal = {-ty / length, tx / length};
  f.offset = (x - s.a[0]) * f.normal[0] + (y - s.a[1]) * f.normal[1];
  return f;
}

}  // namespace

void Terrain::add_line(const std::vector<std::array<double, 2>>& points, const std::vector<double>& friction,
                       bool adhere) {
  if (points.size() < 2) throw InputError("a terrain line needs at least 2 points");
  std::vector<Segment> line;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (points[i] == points[i + 1]) throw InputError("a terrain line has the same point twice in a row");
    line.push_back({points[i], points[i + 1], friction[i], adhere});
  }
  lines_.push_back(std::move(line));
}

int Terrain::contacts(double x, double y, double reach, std::array<TerrainPoint, 2>& found, bool& adhere) const {
  int count = 0;
  adhere = false;
  for (const auto& line : lines_) {
    std::size_t best = 0;
    Foot nearest{};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Foot f = foot_on(line[i], x, y, i == 0, i + 1 == line.size());
      // Of two segments that share the nearest corner, the one that the point is farther off decides the side.
      if (f.squared < least * (1.0 - 1e-12) ||
          (f.squared <= least * (1.0 + 1e-12) && std::fabs(f.offset) > std::fabs(nearest.offset))) {
        least = f.squared;
        nearest = f;
        best = i;
      }
    }
    const double sign = nearest.offset < 0.0 ? -1.0 : 1.0, away = std::sqrt(least);
    if (sign * away > reach || count == 2) continue;
    TerrainPoint c{sign * away, nearest.normal, line[best].friction};
    if (away > 1e-9 * (std::fabs(x) + std::fabs(y) + 1.0) && std::fabs(std::fabs(nearest.offset) - away) > 1e-9 * away)
      c.normal = {sign * (x - nearest.point[0]) / away, sign * (y - nearest.point[1]) / away};
    found[count++] = c;
    adhere = adhere || line[best].adhere;
    // Re-entrant corner: the neighbouring segment turns towards the material and is within reach as well.
    for (const int step : {-1, 1}) {
      const std::size_t other = best + step;
      if (count == 2 || other >= line.size()) continue;
      const Foot f = foot_on(line[other], x, y, other == 0, other + 1 == line.size());
      const Segment &l = step < 0 ? line[other] : line[best], &r = step < 0 ? line[best] : line[other];
      const double turn = (l.b[0] - l.a[0]) * (r.b[1] - r.a[1]) - (l.b[1] - l.a[1]) * (r.b[0] - r.a[0]);
      if (turn > 0.0 && f.offset <= reach && f.squared < 4.0 * reach * reach)
        found[count++] = {f.offset, f.normal, line[other].friction};
    }
  }
  return count;
}

double Terrain::distance(double x, double y) const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& line : lines_) {
    Foot nearest{};
    double squared = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Foot f = foot_on(line[i], x, y, i == 0, i + 1 == line.size());
      if (f.squared < squared * (1.0 - 1e-12) ||
          (f.squared <= squared * (1.0 + 1e-12) && std::fabs(f.offset) > std::fabs(nearest.offset))) {
        squared = f.squared;
        nearest = f;
      }
    }
    const double d = (nearest.offset < 0.0 ? -1.0 : 1.0) * std::sqrt(squared);
    if (d < least) least = d;
  }
  return least;
}

}  // namespace tailrun::mpm

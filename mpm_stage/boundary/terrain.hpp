// The ground that particles run over: polylines with the material's side on the left, each segment with a friction
// coefficient. In 3-D a line of the x-y plane is drawn out along z (y up).
#pragma once

#include <array>
#include <string>
#include <vector>

namespace tailrun::mpm {

// Signed distance (m, positive where material may be), unit normal towards the material, friction coefficient.
struct TerrainPoint {
  double distance;
  std::array<double, 2> normal;
  double friction;
};

class Terrain {
 public:
  struct Segment {
    std::array<double, 2> a, b;  // m
    double friction;             // 1
    bool adhere;                 // no separation, no sliding
  };

  // A polyline of n points; `friction` has one value per segment. Its first and last segments reach to infinity, so
  // that nothing falls past an end. Throws InputError for fewer than 2 points or two equal neighbours.
  void add_line(const std::vector<std::array<double, 2>>& points, const std::vector<double>& friction, bool adhere);

  bool empty() const { return lines_.empty(); }

  // Up to two contacts of the point (x, y) nearer than `reach` (m): the nearest segment of each line, and in a
  // re-entrant corner (where material lies between two segments) the second one too. Returns how many.
  int contacts(double x, double y, double reach, std::array<TerrainPoint, 2>& found, bool& adhere) const;

  // Nearest signed distance; +infinity without terrain.
  double distance(double x, double y) const;

  const std::vector<std::vector<Segment>>& lines() const { return lines_; }

 private:
  std::vector<std::vector<Segment>> lines_;
};

}  // namespace tailrun::mpm

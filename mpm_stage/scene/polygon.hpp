// Polygons of the case file: closed, in the x-y plane, corners as x, y, x, y, ... (m).
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace tailrun::mpm {

// Even-odd rule.
bool inside_polygon(const std::vector<double>& polygon, double x, double y);

// m2; meaningless where the outline crosses itself.
double polygon_area(const std::vector<double>& polygon);

// m
double polygon_perimeter(const std::vector<double>& polygon);

// Two edges that cross each other, numbered from their first corner, and where (m).
struct PolygonCrossing {
  std::size_t first, second;
  std::array<double, 2> point;
};

// The first two edges that cross inside both; edges that only touch do not.
std::optional<PolygonCrossing> polygon_crossing(const std::vector<double>& polygon);

}  // namespace tailrun::mpm

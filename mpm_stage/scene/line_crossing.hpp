// Whether a polyline crosses or touches itself: ground on the left of such a line is ground on its right as well.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace tailrun::mpm {

struct LineCrossing {
  std::size_t first, second;    // segments by their first points; first < second
  std::array<double, 2> place;  // m, that both have
};

// A pair of segments that have more in common than the point between neighbours; nothing for a line that has none. A
// ring (last point equal to the first) may close. Lines that go one way along x or y cost one pass.
std::optional<LineCrossing> first_crossing(const std::vector<std::array<double, 2>>& points);

}  // namespace tailrun::mpm

// Mean of a nodal field over the four corners of a quadrilateral: the value at the centre that its one stress point
// sees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tailrun {

// `quads` (M, 4) node numbers, `nodal` (N); the unit of the result is that of `nodal`.
inline double element_mean(std::span<const std::int64_t> quads, std::span<const double> nodal, std::size_t element) {
  double sum = 0.0;
  for (std::size_t a = 0; a < 4; ++a) sum += 0.25 * nodal[static_cast<std::size_t>(quads[4 * element + a])];
  return sum;
}

}  // namespace tailrun

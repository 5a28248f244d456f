// Which part of the ground's surface in a node's reach soil lies on. What phi = 0 soil carries along the ground goes by
// that area; with a node's whole surface for it, a slab slid as if it were 2.35 cells longer than it is, and the tongue
// of a flow stopped early by that much of its length.
#pragma once

#include <array>
#include <cstdint>

#include "mpm_stage/grid/covered_bins.hpp"

namespace tailrun::mpm {

template <int Dim>
struct GroundCover {
  static constexpr int bins = Dim == 2 ? 24 : 8;  // in a direction; 3-D has as many again along z
  static constexpr double thickness = 1.0;  // cells, up to which the middle of what lies on the ground is above it
  using Line = CoveredBins<bins>;
  using Bits = std::uint64_t;
  static constexpr Bits all = Line::below(Dim == 2 ? bins : bins * bins);

  // Of the ground as seen along x, and along y where it is steeper than 45 degrees; in 3-D a row of `bins` for each bin
  // along z.
  std::array<Bits, 2> along{};

  GroundCover& operator|=(const GroundCover& o) {
    along[0] |= o.along[0];
    along[1] |= o.along[1];
    return *this;
  }

  // A factor that turns a line of bins into the same line in all rows of `along_z` (3-D).
  static Bits rows_at(Bits along_z) {
    Bits first_of_row = 0;
    for (int k = 0; k < bins; ++k) first_of_row |= (along_z >> k & 1) << k * bins;
    return first_of_row;
  }

  // Without the holes between particles.
  static Bits whole(Bits covered) {
    if constexpr (Dim == 2) {
      return Line::closed(covered);
    } else {
      Bits closed = 0;
      for (int k = 0; k < bins; ++k) {
        closed |= Line::closed(covered >> k * bins & Line::below(bins)) << k * bins;
        Bits across = 0;
        for (int i = 0; i < bins; ++i) across |= (covered >> (i * bins + k) & 1) << i;
        across = Line::closed(across);
        for (int i = 0; i < bins; ++i) closed |= (across >> i & 1) << (i * bins + k);
      }
      return closed;
    }
  }
};

// A node's own part of the ground's surface, bin by bin.
template <int Dim>
struct GroundShare {
  static constexpr int bins = GroundCover<Dim>::bins;
  int axis = 0;                    // of the bins: 0 along x, 1 along y
  double whole = 0.0;              // m, in 3-D m2
  std::array<float, bins> part{};  // the same

  // m, in 3-D m2, of it under soil.
  double under(const GroundCover<Dim>& soil) const {
    const auto bits = GroundCover<Dim>::whole(soil.along[static_cast<std::size_t>(axis)]);
    if (bits == GroundCover<Dim>::all) return whole;
    double sum = 0.0;
    for (int i = 0; i < bins; ++i) {
      if constexpr (Dim == 2) {
        if (bits >> i & 1) sum += part[static_cast<std::size_t>(i)];
      } else {
        for (int k = 0; k < bins; ++k)
          if (bits >> (k * bins + i) & 1) sum += part[static_cast<std::size_t>(i)] * GroundCover<Dim>::Line::weight(k);
      }
    }
    return sum;
  }
};

}  // namespace tailrun::mpm

// From the least to the largest of the coordinates that were added to it.
#pragma once

#include <algorithm>
#include <limits>

namespace tailrun::mpm {

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();  // m
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double length() const { return high - low; }
};

}  // namespace tailrun::mpm

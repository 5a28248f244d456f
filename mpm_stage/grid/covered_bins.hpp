// Which part of a line through a node lies under soil. The three cells of the node's reach are cut into bins; a
// particle covers those whose middle is under it. Between particles that are no farther apart than `widest_hole` there
// is no hole, for soil in random packing is whole; so what a body covers ends where the body ends, to half a bin.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tailrun::mpm {

// Integral of the quadratic B-spline from -1.5 to x (cells).
inline double spline_up_to(double x) {
  const double b = std::max(0.0, 1.5 - std::fabs(x)), tail = b * b * b / 6.0;
  if (x < -0.5) return tail;
  return x > 0.5 ? 1.0 - tail : 0.5 + 0.75 * x - x * x * x / 3.0;
}

template <int Bins>
struct CoveredBins {
  static constexpr double reach = 1.5;        // cells, to both sides of the node
  static constexpr double widest_hole = 1.5;  // cells
  using Bits = std::uint64_t;

  static constexpr Bits below(int n) { return n >= 64 ? ~Bits{0} : (Bits{1} << n) - 1; }

  // The bins whose middle lies within `half` of `centre`; both in cells, from the node.
  static Bits under(double centre, double half) {
    const double low = std::clamp((centre - half + reach) * per_cell + 0.5, 0.0, double{Bins});
    const double high = std::clamp((centre + half + reach) * per_cell + 0.5, 0.0, double{Bins});
    return below(static_cast<int>(high)) & ~below(static_cast<int>(low));
  }

  // Without the holes between particles: what is within half a hole of a bin that is covered, less what is within half
  // a hole of what then is not. Nothing is known of what lies beyond the reach: it takes nothing away.
  static Bits closed(Bits line) {
    constexpr int half_hole = static_cast<int>(0.5 * widest_hole * per_cell);
    for (int k = 0; k < half_hole; ++k) line |= (line << 1 | line >> 1) & below(Bins);
    Bits open = ~line & below(Bins);
    for (int k = 0; k < half_hole; ++k) open |= (open << 1 | open >> 1) & below(Bins);
    return ~open & below(Bins);
  }

  // The part of a quadratic B-spline that lies in bin k.
  static double weight(int k) {
    static const auto weights = [] {
      std::array<double, Bins> w{};
      for (int i = 0; i < Bins; ++i)
        w[static_cast<std::size_t>(i)] = spline_up_to((i + 1) / per_cell - reach) - spline_up_to(i / per_cell - reach);
      return w;
    }();
    return weights[static_cast<std::size_t>(k)];
  }
  // That in all bins of `line`; 1: all of it.
  static double share(Bits line) {
    if (line == below(Bins)) return 1.0;
    double sum = 0.0;
    for (int k = 0; k < Bins; ++k)
      if (line >> k & 1) sum += weight(k);
    return sum;
  }

 private:
  static constexpr double per_cell = Bins / (2.0 * reach);
};

}  // namespace tailrun::mpm

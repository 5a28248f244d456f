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

  // seen[0 .. Nodes): the bins whose middle lies within `half` of `centre`, as seen from the nodes at 0, 1 ...; all in
  // cells.
  template <int Nodes>
  [[gnu::always_inline]] static void under(double centre, double half, Bits* seen) {
    if constexpr (Bins % 3 == 0) {  // one line for all of them, each node's begins a cell further on
      const Bits line = between<Bins + (Nodes - 1) * (Bins / 3)>(centre, half);
      for (int n = 0; n < Nodes; ++n) seen[n] = line >> n * (Bins / 3) & below(Bins);
    } else {
      for (int n = 0; n < Nodes; ++n) seen[n] = between<Bins>(centre - n, half);
    }
  }

  // Without the holes between particles: what is within half a hole of a bin that is covered, less what is within half
  // a hole of what then is not. Nothing is known of what lies beyond the reach: it takes nothing away.
  static Bits closed(Bits line) {
    if (line == below(Bins)) return line;
    return ~widened(~widened(line) & below(Bins)) & below(Bins);
  }

  // The part of a quadratic B-spline that lies in bin k.
  static double weight(int k) { return weights[static_cast<std::size_t>(k)]; }
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

  // By half a hole to both sides. What is already widened by w leaves no gap when it is moved by 2 w + 1.
  static Bits widened(Bits line) {
    constexpr int half_hole = static_cast<int>(0.5 * widest_hole * per_cell);
    for (int by = 0; by < half_hole;) {
      const int step = std::min(2 * by + 1, half_hole - by);
      line |= (line << step | line >> step) & below(Bins);
      by += step;
    }
    return line;
  }

  // Of bins 0 .. count, of which the first begins `reach` below 0.
  template <int Count>
  [[gnu::always_inline]] static Bits between(double centre, double half) {
    static_assert(Count < 64);
    const double low = std::clamp((centre - half + reach) * per_cell + 0.5, 0.0, double{Count});
    const double high = std::clamp((centre + half + reach) * per_cell + 0.5, 0.0, double{Count});
    return (Bits{1} << static_cast<int>(high)) - (Bits{1} << static_cast<int>(low));
  }

  static inline const std::array<double, Bins> weights = [] {
    std::array<double, Bins> w{};
    for (int i = 0; i < Bins; ++i)
      w[static_cast<std::size_t>(i)] = spline_up_to((i + 1) / per_cell - reach) - spline_up_to(i / per_cell - reach);
    return w;
  }();
};

}  // namespace tailrun::mpm

// What this machine can do at best, measured here and now: memory bandwidth by McCalpin's STREAM triad and peak rate of
// double-precision multiply-adds. Figures of kernels are given as shares of these.
#pragma once

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace tailrun::bench {

inline double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Bytes per second of a[i] = b[i] + s c[i] over arrays far larger than the caches (24 bytes per entry; the line that is
// fetched before it is overwritten does not count, as in STREAM). Best of five.
inline double triad_bandwidth(int threads) {
  constexpr std::size_t n = std::size_t{1} << 25;
  std::vector<double> a(n), b(n), c(n);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t i = 0; i < n; ++i) {
    a[i] = 0.0;
    b[i] = 1.0;
    c[i] = 2.0;
  }
  double best = 1e300;
  for (int round = 0; round < 5; ++round) {
    const double since = seconds(), s = 1.0 + round;
    double* __restrict to = a.data();
    const double* __restrict from = b.data(), * __restrict also = c.data();
#pragma omp parallel for simd schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i] + s * also[i];
    best = std::min(best, seconds() - since);
  }
  return 24.0 * static_cast<double>(n) / best;
}

// Floating point operations per second of one core: twelve independent chains of four-lane multiply-adds (two flops
// per lane), enough to hide their latency. Best of five.
inline double multiply_add_rate() {
  using Lane4 = double __attribute__((vector_size(32)));
  constexpr int chains = 12;
  constexpr long rounds = 4'000'000;
  double best = 1e300, sink = 0.0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    Lane4 x[chains];
    for (int k = 0; k < chains; ++k) x[k] = Lane4{1.0, 1.1, 1.2, 1.3} * (1.0 + k);
    const Lane4 a = Lane4{0.5, 0.5, 0.5, 0.5} + 1e-9 * repeat, b = {1e-3, 1e-3, 1e-3, 1e-3};
    const double since = seconds();
    for (long r = 0; r < rounds; ++r) {
#pragma GCC unroll 12
      for (int k = 0; k < chains; ++k) x[k] = x[k] * a + b;
    }
    best = std::min(best, seconds() - since);
    for (const Lane4& lane : x) sink += lane[0] + lane[1] + lane[2] + lane[3];
  }
  return sink == 12345.0 ? 0.0 : 8.0 * chains * static_cast<double>(rounds) / best;
}

}  // namespace tailrun::bench

// Four doubles as one value, of which a step makes two uses: a grid node is such a value (mass and momentum, or
// velocity), so that one particle adds to one node with one load, two multiply-adds and one store; and four particles
// are taken at a time, a lane each, wherever they all do the same. Transposing goes from one to the other.
#pragma once

#include <cstddef>

namespace tailrun::mpm {

using Vec4 = double __attribute__((vector_size(32)));
using Vec2 = double __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

inline Vec4 splat(double a) {
  return Vec4{a, a, a, a};
}

// The same constant, or the part of a coordinate X > 0 before the point, as one particle's number or as four's.
template <class Real>
inline Real constant(double a) {
  if constexpr (sizeof(Real) == sizeof(Vec4))
    return splat(a);
  else
    return a;
}
inline int whole(double X) {
  return static_cast<int>(X);
}
inline Int4 whole(Vec4 X) {
  return __builtin_convertvector(X, Int4);
}
inline double real(int i) {
  return i;
}
inline Vec4 real(Int4 i) {
  return __builtin_convertvector(i, Vec4);
}

inline Vec4 larger(Vec4 a, Vec4 b) {
  return a > b ? a : b;
}
inline Vec4 magnitude(Vec4 a) {
  return larger(a, -a);
}
inline double largest_lane(Vec4 a) {
  const double low = a[0] > a[1] ? a[0] : a[1], high = a[2] > a[3] ? a[2] : a[3];
  return low > high ? low : high;
}

// Rows to columns: a, b, c and d become their lanes 0, 1, 2 and 3.
inline void transpose(Vec4& a, Vec4& b, Vec4& c, Vec4& d) {
  const Vec4 ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vec4 cd0 = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

// Two values that lie at `first` .. `last`, one pair of each of four particles, as two vectors of four lanes.
inline void transpose_pairs(const double* p0, const double* p1, const double* p2, const double* p3, Vec4& x, Vec4& y) {
  const auto pair = [](const double* p) {
    Vec2 v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
  };
  const Vec4 even = __builtin_shufflevector(pair(p0), pair(p2), 0, 1, 2, 3);
  const Vec4 odd = __builtin_shufflevector(pair(p1), pair(p3), 0, 1, 2, 3);
  x = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
  y = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
}

// Four consecutive particles of a column.
struct Group {
  std::size_t first;
  static constexpr int count = 4;

  [[gnu::always_inline]] Vec4 read(const double* column) const {
    Vec4 v;
    __builtin_memcpy(&v, column + first, sizeof v);
    return v;
  }
  [[gnu::always_inline]] void write(double* column, Vec4 v) const { __builtin_memcpy(column + first, &v, sizeof v); }
  [[gnu::always_inline]] Vec4 only(Vec4 v) const { return v; }
};

// The one to three particles at the end of a run: lanes beyond repeat the last one when read and are not written.
struct LastGroup {
  std::size_t first;
  int count;

  Vec4 read(const double* column) const {
    Vec4 v;
    for (int k = 0; k < 4; ++k) v[k] = column[first + static_cast<std::size_t>(k < count ? k : count - 1)];
    return v;
  }
  void write(double* column, Vec4 v) const {
    for (int k = 0; k < count; ++k) column[first + static_cast<std::size_t>(k)] = v[k];
  }
  // `v` with 0 in the lanes of particles that are not there.
  Vec4 only(Vec4 v) const {
    for (int k = count; k < 4; ++k) v[k] = 0.0;
    return v;
  }
};

// action(group) for the particles begin .. end.
template <class Action>
[[gnu::always_inline]] inline void for_each_group(std::size_t begin, std::size_t end, Action action) {
  std::size_t p = begin;
  for (; p + 4 <= end; p += 4) action(Group{p});
  if (p < end) action(LastGroup{p, static_cast<int>(end - p)});
}

}  // namespace tailrun::mpm

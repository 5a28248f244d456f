// Four doubles as one value, of which a step makes two uses: a grid node is such a value (mass and momentum, or
// velocity), so that one particle adds to one node with one load, two multiply-adds and one store; and four particles
// are taken at a time, a lane each, wherever they all do the same. Transposing goes from one to the other.
#pragma once

#include <cmath>
#include <cstddef>

namespace tailrun::mpm {

using Vec4 = double __attribute__((vector_size(32)));
// The same anywhere in an array of doubles. The attributes stand with the name: after the type Clang ignores `aligned`.
using LooseVec4 __attribute__((vector_size(32), aligned(8), may_alias)) = double;
static_assert(alignof(LooseVec4) == alignof(double));
// What comparing four lanes gives: all bits set where it holds.
using Mask4 = long long __attribute__((vector_size(32)));
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
  return Vec4{real(i[0]), real(i[1]), real(i[2]), real(i[3])};
}

// As std::max and std::min: a where it is not a number.
template <class Real>
[[gnu::always_inline]] inline Real larger(Real a, Real b) {
  return a < b ? b : a;
}
template <class Real>
[[gnu::always_inline]] inline Real smaller(Real a, Real b) {
  return b < a ? b : a;
}
// f of every lane, where f has no form for four at a time.
template <class Function>
[[gnu::always_inline]] inline double per_lane(Function f, double a) {
  return f(a);
}
template <class Function>
[[gnu::always_inline]] inline Vec4 per_lane(Function f, Vec4 a) {
  return Vec4{f(a[0]), f(a[1]), f(a[2]), f(a[3])};
}
// Each becomes one instruction for four lanes.
inline Vec4 truncated(Vec4 a) {
  return per_lane([](double x) { return std::trunc(x); }, a);
}
template <class Real>
[[gnu::always_inline]] inline Real root(Real a) {
  return per_lane([](double x) { return std::sqrt(x); }, a);
}
inline Vec4 magnitude(Vec4 a) {
  return larger(a, -a);
}
inline double sum_of_lanes(Vec4 a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
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

// The nodes of four particles, one each, as vectors of four lanes. Halves are put together as they are loaded.
[[gnu::always_inline]] inline void transpose_nodes(const Vec4& p0, const Vec4& p1, const Vec4& p2, const Vec4& p3,
                                                   Vec4* lanes) {
  const Vec4 even = __builtin_shufflevector(p0, p2, 0, 1, 4, 5), odd = __builtin_shufflevector(p1, p3, 0, 1, 4, 5);
  const Vec4 even2 = __builtin_shufflevector(p0, p2, 2, 3, 6, 7), odd2 = __builtin_shufflevector(p1, p3, 2, 3, 6, 7);
  lanes[0] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
  lanes[1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
  lanes[2] = __builtin_shufflevector(even2, odd2, 0, 4, 2, 6);
  lanes[3] = __builtin_shufflevector(even2, odd2, 1, 5, 3, 7);
}
// The same for nodes that have two values, twice each: (a, b, a, b).
inline Vec4 twice(Vec4 node) {
  return __builtin_shufflevector(node, node, 0, 1, 0, 1);
}
inline Vec4 twice(Vec2 node) {
  return __builtin_shufflevector(node, node, 0, 1, 0, 1);
}
// Lanes 0 and 1 of a, 2 and 3 of b. Of integers this becomes a blend, cheaper than the permutation of halves that GCC
// 12 makes of doubles.
[[gnu::always_inline]] inline Vec4 low_and_high(const Vec4& a, const Vec4& b) {
  return reinterpret_cast<Vec4>(
      __builtin_shufflevector(reinterpret_cast<Mask4>(a), reinterpret_cast<Mask4>(b), 0, 1, 6, 7));
}
[[gnu::always_inline]] inline void transpose_doubled(const Vec4& p0, const Vec4& p1, const Vec4& p2, const Vec4& p3,
                                                     Vec4* lanes) {
  const Vec4 even = low_and_high(p0, p2), odd = low_and_high(p1, p3);
  lanes[0] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
  lanes[1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
}

// `p`, worked out now: the compiler would otherwise make a sum of its own for every element that is read and written.
template <class T>
[[gnu::always_inline]] inline T* one_address(T* p) {
  __asm__("" : "+r"(p));
  return p;
}

// Four consecutive particles of a column.
struct Group {
  std::size_t first;
  static constexpr int count = 4;

  [[gnu::always_inline]] Vec4 read(const double* column) const {
    return *reinterpret_cast<const LooseVec4*>(column + first);
  }
  [[gnu::always_inline]] void write(double* column, Vec4 v) const { *reinterpret_cast<LooseVec4*>(column + first) = v; }
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

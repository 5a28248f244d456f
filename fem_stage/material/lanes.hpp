// Four numbers that go through the same arithmetic, one for each of four material points: the constitutive equations
// are long chains of square roots, divisions and exponentials in which a processor mostly waits for the number before,
// and it waits for four as long as for one. The functions of pm4_law.hpp and pm4_rates.hpp are templates over the
// number type, which is double or Lanes; what a branch is for doubles is `select` between both sides for Lanes. Every
// lane's arithmetic is its own, so its result does not depend on what the others carry.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#ifdef __AVX__
#include <immintrin.h>
#endif

// Functions with Lanes in their signatures are inlined or internal to one file, so their calling convention does not
// matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tailrun::fem {

constexpr std::size_t lane_count = 4;

struct Lanes {
  typedef double Vector __attribute__((vector_size(8 * lane_count)));
  Vector v;

  Lanes() = default;
  // Implicit, so that constants mix with lanes as they do with doubles.
  Lanes(double x) : v{x, x, x, x} {}
  explicit Lanes(Vector x) : v(x) {}
  double operator[](std::size_t lane) const { return v[lane]; }
  void set(std::size_t lane, double x) { v[lane] = x; }

  friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  friend Lanes operator-(Lanes a) { return Lanes(-a.v); }
  Lanes& operator+=(Lanes b) { return *this = *this + b; }
  Lanes& operator*=(Lanes b) { return *this = *this * b; }
};

struct LaneMask {
  typedef std::int64_t Vector __attribute__((vector_size(8 * lane_count)));
  Vector v;

  bool operator[](std::size_t lane) const { return v[lane] != 0; }
  friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.v & b.v}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.v | b.v}; }
  friend LaneMask operator!(LaneMask a) { return {~a.v}; }
};

inline LaneMask operator<(Lanes a, Lanes b) {
  return {a.v < b.v};
}
inline LaneMask operator<=(Lanes a, Lanes b) {
  return {a.v <= b.v};
}
inline LaneMask operator>(Lanes a, Lanes b) {
  return {a.v > b.v};
}
inline LaneMask operator>=(Lanes a, Lanes b) {
  return {a.v >= b.v};
}
inline bool any(LaneMask m) {
#ifdef __AVX__
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(m.v)) != 0;
#else
  return ((m.v[0] | m.v[1]) | (m.v[2] | m.v[3])) != 0;
#endif
}
inline bool any(bool condition) {
  return condition;
}

inline Lanes select(LaneMask m, Lanes a, Lanes b) {
  return Lanes(m.v ? a.v : b.v);
}
inline double select(bool m, double a, double b) {
  return m ? a : b;
}

// The functions of <cmath> and <algorithm> that the equations use, by names that work for both number types. Lanes take
// Eigen's vector exponential and logarithm.
namespace number {
inline double sqrt(double x) {
  return std::sqrt(x);
}
inline double exp(double x) {
  return std::exp(x);
}
inline double log(double x) {
  return std::log(x);
}
inline double pow(double x, double y) {
  return std::pow(x, y);
}
inline double abs(double x) {
  return std::fabs(x);
}
inline double max(double a, double b) {
  return std::max(a, b);
}
inline double min(double a, double b) {
  return std::min(a, b);
}

template <class Function>
inline Lanes with_eigen(Lanes x, Function&& function) {
  using Array = Eigen::Array<double, lane_count, 1>;
  Array in, out;
  std::memcpy(in.data(), &x.v, sizeof x.v);
  out = function(in);
  std::memcpy(&x.v, out.data(), sizeof x.v);
  return x;
}
inline Lanes sqrt(Lanes x) {
  return with_eigen(x, [](const auto& a) { return a.sqrt(); });
}
inline Lanes exp(Lanes x) {
  return with_eigen(x, [](const auto& a) { return a.exp(); });
}
inline Lanes log(Lanes x) {
  return with_eigen(x, [](const auto& a) { return a.log(); });
}
inline Lanes pow(Lanes x, double y) {
  return exp(y * log(x));
}
inline Lanes abs(Lanes x) {
  return select(x < 0.0, -x, x);
}
inline Lanes max(Lanes a, Lanes b) {
  return select(a < b, b, a);
}
inline Lanes min(Lanes a, Lanes b) {
  return select(b < a, b, a);
}
}  // namespace number

template <class Real>
inline Real clamp_to(Real x, Real low, Real high) {
  return number::min(number::max(x, low), high);
}

// Structures of lanes have the numbers of the structure of doubles one by one, so their lanes are filled and read by
// position.
template <template <class> class Structure>
Structure<Lanes> gather(const Structure<double>& a, const Structure<double>& b, const Structure<double>& c,
                        const Structure<double>& d) {
  static_assert(lane_count == 4 && sizeof(Structure<Lanes>) == lane_count * sizeof(Structure<double>));
  constexpr std::size_t count = sizeof(Structure<double>) / sizeof(double);
  Structure<Lanes> all;
  const double* from[] = {reinterpret_cast<const double*>(&a), reinterpret_cast<const double*>(&b),
                          reinterpret_cast<const double*>(&c), reinterpret_cast<const double*>(&d)};
  Lanes* to = reinterpret_cast<Lanes*>(&all);
  for (std::size_t i = 0; i < count; ++i) to[i] = Lanes(Lanes::Vector{from[0][i], from[1][i], from[2][i], from[3][i]});
  return all;
}
template <template <class> class Structure>
void take_lane(const Structure<Lanes>& all, std::size_t lane, Structure<double>& one) {
  static_assert(sizeof(Structure<Lanes>) == lane_count * sizeof(Structure<double>));
  constexpr std::size_t count = sizeof(Structure<double>) / sizeof(double);
  double* to = reinterpret_cast<double*>(&one);
  const double* from = reinterpret_cast<const double*>(&all) + lane;
  for (std::size_t i = 0; i < count; ++i) to[i] = from[lane_count * i];
}

}  // namespace tailrun::fem

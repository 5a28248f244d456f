// One-dimensional shape functions of the background grid; 2-D and 3-D ones are their products.
//
// Each gives, for a coordinate X measured in cells from node 0 of a tile (X > 0), the lowest node that it touches and,
// for its `support` nodes k = base .. base + support - 1,
//   w[k] weight,  d[k] derivative with respect to X,  m[k] = w[k] (k - X) first moment.
// `shift`: a point belongs to the block that holds floor(X + shift). `apic`: D^-1 h^2 of the affine velocity (Jiang et
// al. 2015, section 5.3), 0 where D is not a constant; then the velocity gradient takes the place of the affine matrix.
// `mass_cutoff`: nodes with less than this share of a particle's mass are left out.
// `largest_stiffness`: of sum d^2 / w over the places in a cell, which a particle alone on its nodes breathes with (not
// needed of cubic B-splines).
#pragma once

#include <cmath>

#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

struct LinearShape {
  static constexpr const char* name = "linear";
  static constexpr int support = 2;
  static constexpr double shift = 0.0;
  static constexpr double apic = 0.0;
  static constexpr double mass_cutoff = 1e-6;
  // cells; a particle closer to a line of nodes is taken to be there. On the line the weight of the nodes beyond is 0
  // and their force is not: what a body with particles on lines of nodes is thrown apart by.
  static constexpr double nearest = 0.1;
  static constexpr double largest_stiffness = 1.0 / nearest + 1.0 / (1.0 - nearest);

  template <class Real>
  [[gnu::always_inline]] static inline auto evaluate(Real X, Real* w, Real* d, Real* m) {
    const auto base = whole(X);
    const Real f = smaller(larger(X - real(base), constant<Real>(nearest)), constant<Real>(1.0 - nearest));
    w[0] = 1.0 - f;
    w[1] = f;
    d[0] = constant<Real>(-1.0);
    d[1] = constant<Real>(1.0);
    m[0] = -w[0] * f;
    m[1] = w[1] * (1.0 - f);
    return base;
  }
};

// Quadratic B-spline (Steffen, Kirby & Berzins 2008): C1, so a particle that crosses a cell feels no jump in gradient.
struct QuadraticShape {
  static constexpr const char* name = "quadratic";
  static constexpr int support = 3;
  static constexpr double shift = 0.5;
  static constexpr double apic = 4.0;
  static constexpr double mass_cutoff = 1e-18;
  static constexpr double largest_stiffness = 6.0;

  template <class Real>
  [[gnu::always_inline]] static inline auto evaluate(Real X, Real* w, Real* d, Real* m) {
    const auto centre = whole(X + 0.5);
    const Real f = X - real(centre);
    const Real a = 0.5 - f, b = 0.5 + f;
    w[0] = 0.5 * a * a;
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * b * b;
    d[0] = -a;
    d[1] = -2.0 * f;
    d[2] = b;
    m[0] = w[0] * (-1.0 - f);
    m[1] = w[1] * -f;
    m[2] = w[2] * (1.0 - f);
    return centre - 1;
  }
};

struct CubicShape {
  static constexpr const char* name = "cubic";
  static constexpr int support = 4;
  static constexpr double shift = 0.0;
  static constexpr double apic = 3.0;
  static constexpr double mass_cutoff = 1e-18;

  template <class Real>
  [[gnu::always_inline]] static inline auto evaluate(Real X, Real* w, Real* d, Real* m) {
    const auto cell = whole(X);
    const Real f = X - real(cell), g = 1.0 - f;
    w[0] = g * g * g * (1.0 / 6.0);
    w[1] = 2.0 / 3.0 - f * f * (1.0 - 0.5 * f);
    w[2] = 2.0 / 3.0 - g * g * (1.0 - 0.5 * g);
    w[3] = f * f * f * (1.0 / 6.0);
    d[0] = -0.5 * g * g;
    d[1] = -2.0 * f + 1.5 * f * f;
    d[2] = 2.0 * g - 1.5 * g * g;
    d[3] = 0.5 * f * f;
    for (int k = 0; k < 4; ++k) m[k] = w[k] * (k - 1.0 - f);
    return cell - 1;
  }
};

// Uniform GIMP (Bardenhagen & Kober 2004): linear functions averaged over a particle half a cell wide.
struct GimpShape {
  static constexpr const char* name = "gimp";
  static constexpr int support = 3;
  static constexpr double shift = 0.5;
  static constexpr double apic = 0.0;
  static constexpr double mass_cutoff = 1e-8;
  static constexpr double largest_stiffness = 28.0 / 3.0;

  // Four particles, one after the other: the pieces of the function differ from lane to lane.
  static inline Int4 evaluate(Vec4 X, Vec4* w, Vec4* d, Vec4* m) {
    Int4 base{};
    for (int lane = 0; lane < 4; ++lane) {
      double weight[3], slope[3], moment[3];
      base[lane] = evaluate(X[lane], weight, slope, moment);
      for (int k = 0; k < 3; ++k) {
        w[k][lane] = weight[k];
        d[k][lane] = slope[k];
        m[k][lane] = moment[k];
      }
    }
    return base;
  }

  static inline int evaluate(double X, double* w, double* d, double* m) {
    constexpr double l = 0.25;  // half the particle's width, in cells
    const int centre = static_cast<int>(X + 0.5);
    const double f = X - centre;
    for (int k = 0; k < 3; ++k) {
      const double r = f - (k - 1.0), a = std::fabs(r), s = r < 0.0 ? -1.0 : 1.0;
      if (a < l) {
        w[k] = 1.0 - (r * r + l * l) / (2.0 * l);
        d[k] = -r / l;
      } else if (a < 1.0 - l) {
        w[k] = 1.0 - a;
        d[k] = -s;
      } else if (a < 1.0 + l) {
        w[k] = (1.0 + l - a) * (1.0 + l - a) / (4.0 * l);
        d[k] = -s * (1.0 + l - a) / (2.0 * l);
      } else {
        w[k] = d[k] = 0.0;
      }
      m[k] = w[k] * -r;
    }
    return centre - 1;
  }
};

// What four particles see along one direction: a line's sums of a quantity u over the nodes,
//   value = sum w u,  slope = sum d u,  moment = sum m u,
// and what nodes get back, e_k = s d_k or c m_k or both, where slopes and s, moments and c are counted in units of
// slope_unit and moment_unit.
struct LineSums {
  Vec4 value, slope, moment;
};

template <class Shape>
struct ShapeAt {
  static constexpr int support = Shape::support;
  static constexpr double slope_unit = 1.0, moment_unit = 1.0;
  Vec4 w[support], d[support], m[support];
  Vec4 base;  // a whole number

  [[gnu::always_inline]] explicit ShapeAt(Vec4 X) : base(real(Shape::evaluate(X, w, d, m))) {}

  [[gnu::always_inline]] LineSums sums(const Vec4* u) const {
    LineSums s{};
    for (int k = 0; k < support; ++k) {
      s.value += u[k] * w[k];
      s.slope += u[k] * d[k];
      s.moment += u[k] * m[k];
    }
    return s;
  }
  [[gnu::always_inline]] void spread_slope(Vec4 s, Vec4* e) const {
    for (int k = 0; k < support; ++k) e[k] = s * d[k];
  }
  [[gnu::always_inline]] void spread_moment(Vec4 c, Vec4* e) const {
    for (int k = 0; k < support; ++k) e[k] = c * m[k];
  }
  [[gnu::always_inline]] void spread_both(Vec4 s, Vec4 c, Vec4* e) const {
    for (int k = 0; k < support; ++k) e[k] = s * d[k] + c * m[k];
  }
};

// The quadratic B-spline by differences of the three nodes, with f measured from the middle one: S = u_2 - u_0 and D =
// u_0 - 2 u_1 + u_2 give value = u_1 + f S / 2 + (f^2 / 2 + 1/8) D, slope = (S + 2 f D) / 2 and moment = (S + f (3 - 4
// f^2) D) / 8. Fewer products, and far fewer numbers to be kept, than with nine weights.
template <>
struct ShapeAt<QuadraticShape> {
  static constexpr double slope_unit = 0.5, moment_unit = 0.125;
  Vec4 w[3], half_f, half_ff, slope_D, moment_D;
  Vec4 base;

  [[gnu::always_inline]] explicit ShapeAt(Vec4 X) {
    const Vec4 centre = truncated(X + 0.5), f = X - centre, ff = f * f;
    base = centre - 1.0;
    half_f = 0.5 * f;
    half_ff = 0.5 * ff + 0.125;
    w[0] = half_ff - half_f;
    w[1] = 0.75 - ff;
    w[2] = half_ff + half_f;
    slope_D = f + f;
    moment_D = f * (3.0 - 4.0 * ff);
  }
  [[gnu::always_inline]] LineSums sums(const Vec4* u) const {
    const Vec4 S = u[2] - u[0], D = (u[0] + u[2]) - 2.0 * u[1];
    return {u[1] + half_ff * D + half_f * S, S + slope_D * D, S + moment_D * D};
  }
  [[gnu::always_inline]] void spread_slope(Vec4 s, Vec4* e) const { spread(s, s * slope_D, e); }
  [[gnu::always_inline]] void spread_moment(Vec4 c, Vec4* e) const { spread(c, c * moment_D, e); }
  [[gnu::always_inline]] void spread_both(Vec4 s, Vec4 c, Vec4* e) const {
    spread(s + c, s * slope_D + c * moment_D, e);
  }

 private:
  [[gnu::always_inline]] static void spread(Vec4 S, Vec4 D, Vec4* e) {
    e[0] = D - S;
    e[1] = -2.0 * D;
    e[2] = D + S;
  }
};

}  // namespace tailrun::mpm

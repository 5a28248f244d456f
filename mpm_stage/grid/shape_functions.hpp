// One-dimensional shape functions of the background grid; 2-D and 3-D ones are their products.
//
// Each gives, for a coordinate X measured in cells from node 0 of a tile (X > 0), the lowest node that it touches and,
// for its `support` nodes k = base .. base + support - 1,
//   w[k] weight,  d[k] derivative with respect to X,  m[k] = w[k] (k - X) first moment.
// `shift`: a point belongs to the block that holds floor(X + shift). `apic`: D^-1 h^2 of the affine velocity (Jiang et
// al. 2015, section 5.3), 0 where D is not a constant; then the velocity gradient takes the place of the affine matrix.
// `mass_cutoff`: nodes with less than this share of a particle's mass are left out. Where the squared slope over the
// weight has no bound as the weight goes to 0 (linear, GIMP), such nodes are thrown about by ever larger accelerations.
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

  template <class Real>
  [[gnu::always_inline]] static inline auto evaluate(Real X, Real* w, Real* d, Real* m) {
    const auto base = whole(X);
    const Real f = X - real(base);
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

}  // namespace tailrun::mpm

// mu_i: dry grains that flow, the mu(I) rheology of Jop, Forterre & Pouliquen (2006, Nature 441, 727): friction that
// grows with the rate of shear, made dimensionless by the size of the grains,
//
//   mu(I) = mu_s + (mu_2 - mu_s) / (1 + I_0 / I),   I = rate d sqrt(rho_s / p),
//
// linear elastic below it. Friction that is constant has no length, and the front of a slide runs on as cells shrink;
// here a front a few grains thin is sheared fast and held back.
//
// The yield surface is Mohr-Coulomb's pyramid without cohesion and dilation, s1 - s3 = -sin(phi) (s1 + s3), with
// sin(phi) = mu(I): at I = 0 it is `mohr_coulomb` with sin(phi) = mu_s for every stress, in plane strain and in 3-D.
// Where grains shear at constant volume, shear over normal stress on the planes of shear is the pyramid's sin(phi):
// there this is Jop's law with no factor between, and mu_s and mu_2 are the tangents of the slopes on which a layer
// stops and beyond which it accelerates without end. Jop's own surface is the cone |tau| = mu p, which is the same
// there; in triaxial compression the cone is weaker than the pyramid (by 23 % for mu = 0.34), in extension by 4 %. p is
// the mean of the largest and least principal stress (> 0 in compression), which is the mean stress in such flow,
// whatever s2 remembers of the time before. `rate` is the plastic rate of shear, sqrt(2 e : e).
//
// The return is implicit: with T = (t1 - t3) / 2 and p of the trial, it ends at R = T - G g = mu(g) p, g the plastic
// shear of the step; mu grows with g, so there is one g, the positive root of a quadratic. On the edges (s2 = s3, s1 =
// s2) stresses are x(mu) from the mean stress and mu is found between bounds. The plastic strain is (1, 0, -1) or
// between two such, so its work is g R >= 0 for any step, and as the step goes to infinity or nothing the stress stays
// between the pyramids of mu_s and mu_2: no viscosity has a say in the time step. In tension grains part: no stress.
//
// Keys: those of elastic_solid.cpp, and what read() has.
#include <cmath>
#include <type_traits>

#include "mpm_stage/material/elastic_solid.hpp"
#include "mpm_stage/material/elasto_plastic.hpp"

namespace tailrun::mpm {

namespace {

struct Own {
  double mu_s, mu_2, I_0;    // 1
  double diameter, density;  // m, kg/m3, of a grain
};

void read(const CaseNode& node, Material& m) {
  // Cure of volumetric locking. Strength follows the mean stress: off, as for mohr_coulomb.
  m.average_volumetric_strain = node.boolean_or("average_volumetric_strain", false);
  read_elastic_solid(node, "frozen", m);
  Own own;
  // Friction at rest and that of fast flow. Glass beads of 0.5 mm: tan 20.9 deg = 0.38, tan 32.76 deg = 0.64 (Jop et
  // al. 2006).
  own.mu_s = node.number("mu_s", "1", Range::between(1e-3, 0.95));
  own.mu_2 = node.number("mu_2", "1", Range::between(own.mu_s, 0.95));
  // I at which half of mu_2 - mu_s has come on; the default is that of glass beads (Jop et al. 2006).
  own.I_0 = node.number_or("I_0", "1", Range::positive(), 0.279);
  // d and rho_s, of the grains themselves; the default is quartz. `density` is that of grains and voids together.
  own.diameter = node.number("grain_diameter", "m", Range::positive());
  own.density = node.number_or("grain_density", "kg/m3", Range::positive(), 2650.0);
  m.own.set(own);
}

// Whether any of one or four is true.
template <class Mask>
[[gnu::always_inline]] inline bool any(const Mask& a) {
  if constexpr (std::is_arithmetic_v<Mask>)
    return a != 0;
  else
    return (a[0] | a[1] | a[2] | a[3]) != 0;
}

// sqrt without the sign of a round-off below 0.
template <class Real>
[[gnu::always_inline]] inline Real positive_root(Real a) {
  return root(larger(a, Real{}));
}

class MuI {
 public:
  // Without a step (dt = 0) nothing has a rate: I = 0.
  explicit MuI(const MaterialConstants& k, double dt = 0.0) : G_(k.mu) {
    const Own own = k.own.get<Own>();
    mu_s_ = own.mu_s;
    mu_2_ = own.mu_2;
    shear_at_half_ = dt > 0.0 ? dt * own.I_0 / (own.diameter * std::sqrt(own.density)) : 1e30;
  }

  template <bool Softens, class Real>
  [[gnu::always_inline]] PrincipalOf<Real> returned(Real /*cohesion*/, Real /*share*/, PrincipalOf<Real> t) const {
    const Real zero = {}, R = 0.5 * (t.s1 - t.s3), p = -0.5 * (t.s1 + t.s3), over = R - mu_s_ * p;
    const auto yields = over > zero;
    if (!any(yields)) return t;
    // G g^2 + b g - over * half = 0, its root in the form that does not cancel.
    const Real half = shear_at_half_ * positive_root(p), b = G_ * half + (mu_2_ - mu_s_) * p - over;
    const Real q = magnitude_of(b) + positive_root<Real>(b * b + 4.0 * G_ * over * half);
    const Real g = b > zero ? 2.0 * over * half / (b > zero ? q : constant<Real>(1.0)) : q * (0.5 / G_);
    const Real radius = R - G_ * g;
    PrincipalOf<Real> s = {radius - p, t.s2, -radius - p};
    const auto off_plane = yields & ((s.s1 < t.s2) | (s.s3 > t.s2) | (p <= zero));
    if (any(off_plane)) {
      const PrincipalOf<Real> e = edge(t, p);
      s = {off_plane ? e.s1 : s.s1, off_plane ? e.s2 : s.s2, off_plane ? e.s3 : s.s3};
    }
    return {yields ? s.s1 : t.s1, yields ? s.s2 : t.s2, yields ? s.s3 : t.s3};
  }

  template <bool Softens, class Real>
  [[gnu::always_inline]] Real sin_phi(Real /*share*/) const {
    return constant<Real>(mu_s_);
  }

 private:
  static double magnitude_of(double a) { return std::fabs(a); }
  static Vec4 magnitude_of(Vec4 a) { return magnitude(a); }

  // The return of trials that leave the plane: to s2 = s3 where s2 lies below the middle of the others (`side` = 1), to
  // s1 = s2 otherwise (-1), or to no stress where the mean is tension. With x = s1 - s3 the surface is x = 6 mu m / (3
  // + side mu), m the mean stress, which stays.
  template <class Real>
  PrincipalOf<Real> edge(const PrincipalOf<Real>& t, Real p) const {
    const Real zero = {}, one = constant<Real>(1.0);
    const Real mean = larger<Real>((t.s1 + t.s2 + t.s3) * (-1.0 / 3.0), zero);
    const auto low = t.s2 + p < zero;
    const Real side = low ? one : -one;
    const Real X = low ? t.s1 - 0.5 * (t.s2 + t.s3) : 0.5 * (t.s1 + t.s2) - t.s3;
    const Real Y = low ? t.s2 - t.s3 : t.s1 - t.s2, across = Y * Y;
    // (mu - mu_s) (g + half) - (mu_2 - mu_s) g: below 0 while the shear of the step asks for more friction.
    const auto excess = [&](Real mu) __attribute__((always_inline)) {
      const Real x = 6.0 * mu * mean / (3.0 + side * mu), along = larger<Real>(X - x, zero);
      const Real g = (0.5 / G_) * root<Real>(4.0 / 3.0 * along * along + across);
      const Real half = shear_at_half_ * positive_root<Real>(mean - side * x * (1.0 / 6.0));
      return (mu - mu_s_) * (g + half) - (mu_2_ - mu_s_) * g;
    };
    // At `end` the plane would take over, or mu is mu_2: the bounds hold the root whatever the function does between.
    const Real end = p > zero ? magnitude_of(t.s2 + p) / (p > zero ? p : one) : constant<Real>(mu_2_);
    Real a = constant<Real>(mu_s_), c = larger<Real>(a, smaller<Real>(end, constant<Real>(mu_2_)));
    Real fa = excess(a), fc = excess(c), mu = c;
    // Regula falsi that halves the value at an end kept twice (the Illinois rule), which cannot leave its bounds.
    Real kept = zero;
    for (int tries = 0; tries < 60; ++tries) {
      const Real width = fc - fa;
      const auto flat = (width > zero) | (width < zero);
      const Real next = flat ? (a * fc - c * fa) / (flat ? width : one) : c;
      const Real f = excess(next), moved = magnitude_of(next - mu);
      mu = next;
      const auto above = f > zero;
      const auto a_again = above & (kept > zero), c_again = (f <= zero) & (kept < zero);
      const Real halve_a = a_again ? 0.5 * one : one, halve_c = c_again ? 0.5 * one : one;
      c = above ? next : c;
      fc = above ? f : fc * halve_c;
      a = above ? a : next;
      fa = above ? fa * halve_a : f;
      kept = above ? one : -one;
      if (!any(moved > constant<Real>(1e-13))) break;
    }
    const Real x = 6.0 * mu * mean / (3.0 + side * mu), third = x * (1.0 / 3.0);
    return {(low ? 2.0 * third : third) - mean, (low ? -third : third) - mean, (low ? -third : -2.0 * third) - mean};
  }

  double G_, mu_s_, mu_2_;
  double shear_at_half_;  // 1 / sqrt(Pa): times sqrt(p) the shear of a step with I = I_0
};

void set_constants(const Material& m, double /*cell_size*/, MaterialConstants& k) {
  set_elastic_constants(m, k);
  k.own = m.own;
  set_elasto_plastic_loops<MuI>(k);
}

}  // namespace

namespace laws {
extern const MaterialLaw mu_i = {
    .name = "mu_i", .read = read, .set_constants = set_constants, .returned = elasto_plastic_return<MuI>};
}

}  // namespace tailrun::mpm

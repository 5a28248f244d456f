// mohr_coulomb: soil with friction, linear elastic up to the Mohr-Coulomb pyramid, with cohesion and dilation.
//
// Yield planes k s1 - s3 = s_c with k = (1 + sin phi) / (1 - sin phi), s_c = 2 c sqrt(k), principal stresses s1 >= s2
// >= s3, tension positive; flow follows the potential m s1 - s3 with m from the dilation angle psi. The return is
// Clausen, Damkilde & Andersen's (2006, 2007) in closed form: to the plane; where that is not ordered, to one of the
// edges s = s_a + t (1, k, k) (s2 = s3) and s_a + t (1, 1, k) (s1 = s2); beyond their end to the apex s_a = s_c / (k -
// 1). Plastic strains off an edge are normal to the potential's edge r_g, so t = r_g D^-1 (s - s_a) / (r_g D^-1 r_l).
//
// Strength follows the mean stress. So neither volumetric averages nor relaxation are on by default (each push over the
// yield surface compacts the soil a little, without end), and the soil is computed in effective stresses.
//
// Keys: those of elastic_solid.cpp and soil_strength.cpp, and what read() has. Softening may take friction along.
#include <cmath>
#include <numbers>

#include "mpm_stage/material/elastic_solid.hpp"
#include "mpm_stage/material/elasto_plastic.hpp"
#include "mpm_stage/material/soil_strength.hpp"

namespace tailrun::mpm {

namespace {

void read(const CaseNode& node, Material& m) {
  // Cure of volumetric locking.
  m.average_volumetric_strain = node.boolean_or("average_volumetric_strain", false);
  read_elastic_solid(node, "frozen", m);
  // phi' and psi.
  m.friction_angle = node.number("friction_angle", "deg", Range::between(0.1, 60.0));
  m.dilation_angle = node.number_or("dilation_angle", "deg", Range::between(0.0, m.friction_angle), 0.0);
  read_strength(node, m);
  if (const auto soft = read_softening(node, m))
    // Of phi'; friction softens only if it is given.
    if (const auto phi = soft->number_if("residual_friction_angle", "deg", Range::between(0.1, m.friction_angle)))
      m.softening.residual_friction = *phi;
}

struct Own {
  double sin_phi, sin_phi_residual;
  double m;  // (1 + sin psi) / (1 - sin psi)
};

// What the return needs of elasticity, friction and dilation, with every quotient worked out beforehand: friction that
// does not soften costs no division per particle.
template <class Real>
struct Surface {
  Real k, root2;          // root2 = 2 sqrt(k)
  Real apex;              // apex stress per unit of s_c
  Real D1, D2, D3;        // D b over a D b
  Real a1, a23, b12, b3;  // coordinates of a stress along the two edges
};

template <class Real>
[[gnu::always_inline]] inline Surface<Real> surface_of(const MaterialConstants& e, double m, Real sin_phi) {
  const double l = e.lambda, G2 = 2.0 * e.mu;
  Surface<Real> s;
  s.k = (1.0 + sin_phi) / (1.0 - sin_phi);
  s.root2 = 2.0 * root(s.k);
  s.apex = 1.0 / (s.k - 1.0);
  // D b = ((l + 2G) m - l, l (m - 1), l m - (l + 2G)), a = (k, 0, -1).
  const double D1 = (l + G2) * m - l, D2 = l * (m - 1.0), D3 = l * m - (l + G2);
  const Real r = 1.0 / (s.k * D1 - D3);
  s.D1 = D1 * r;
  s.D2 = D2 * r;
  s.D3 = D3 * r;
  // D^-1 r is proportional to r (1 + nu) - nu tr(r), and 2 nu = l / (l + G).
  const double nu = 0.5 * l / (l + 0.5 * G2);
  const double tr_a = 1.0 + 2.0 * m, a1 = 1.0 + nu - nu * tr_a, a2 = m * (1.0 + nu) - nu * tr_a;
  const double tr_b = 2.0 + m, b1 = 1.0 + nu - nu * tr_b, b3 = m * (1.0 + nu) - nu * tr_b;
  const Real ra = 1.0 / (a1 + 2.0 * a2 * s.k), rb = 1.0 / (2.0 * b1 + b3 * s.k);
  s.a1 = a1 * ra;
  s.a23 = a2 * ra;
  s.b12 = b1 * rb;
  s.b3 = b3 * rb;
  return s;
}

// The stress on or inside the yield surface. `c` Pa. Any trial stress is admissible.
template <class OfSurface, class Real>
[[gnu::always_inline]] inline PrincipalOf<Real> return_to(const Surface<OfSurface>& e, Real c, PrincipalOf<Real> t) {
  const Real zero = {}, strength = e.root2 * c, f = e.k * t.s1 - t.s3 - strength;
  const Real p1 = t.s1 - f * e.D1, p2 = t.s2 - f * e.D2, p3 = t.s3 - f * e.D3;
  const Real apex = strength * e.apex;
  const Real d1 = t.s1 - apex, d2 = t.s2 - apex, d3 = t.s3 - apex;
  // Where the plane's return is not ordered, the edge that the trial leans towards decides; beyond its end lies the
  // apex.
  const Real ta = smaller<Real>(e.a1 * d1 + e.a23 * (d2 + d3), zero);
  const Real tb = smaller<Real>(e.b12 * (d1 + d2) + e.b3 * d3, zero);
  const auto lower = p2 - p3 < p1 - p2;
  const Real along1 = lower ? ta : tb, along2 = lower ? e.k * ta : tb;
  const Real q1 = apex + along1, q2 = apex + along2, q3 = apex + e.k * along1;
  const auto ordered = (p1 >= p2) & (p2 >= p3);
  const auto yields = f > zero;
  const Real r1 = ordered ? p1 : q1, r2 = ordered ? p2 : q2, r3 = ordered ? p3 : q3;
  return {yields ? r1 : t.s1, yields ? r2 : t.s2, yields ? r3 : t.s3};
}

class MohrCoulomb {
 public:
  explicit MohrCoulomb(const MaterialConstants& k) : k_(k) {
    const Own own = k.own.get<Own>();
    m_ = own.m;
    peak_sin_ = own.sin_phi;
    residual_sin_ = own.sin_phi_residual;
    peak_ = surface_of(k, m_, peak_sin_);
  }

  template <bool Softens, class Real>
  [[gnu::always_inline]] PrincipalOf<Real> returned(Real cohesion, Real share, PrincipalOf<Real> trial) const {
    if constexpr (Softens)
      return return_to(surface_of(k_, m_, sin_phi<true>(share)), cohesion, trial);
    else
      return return_to(peak_, cohesion, trial);
  }

  template <bool Softens, class Real>
  [[gnu::always_inline]] Real sin_phi(Real share) const {
    if constexpr (Softens)
      return residual_sin_ + (peak_sin_ - residual_sin_) * share;
    else
      return constant<Real>(peak_sin_);
  }

 private:
  const MaterialConstants& k_;
  double m_, peak_sin_, residual_sin_;  // 1
  Surface<double> peak_;
};

void set_constants(const Material& m, double cell_size, MaterialConstants& k) {
  constexpr double degree = std::numbers::pi / 180.0;
  set_elastic_constants(m, k);
  set_strength_constants(m, cell_size, k);
  Own own;
  own.sin_phi = std::sin(m.friction_angle * degree);
  own.m = (1.0 + std::sin(m.dilation_angle * degree)) / (1.0 - std::sin(m.dilation_angle * degree));
  const double residual = m.softening.residual_friction;
  own.sin_phi_residual = m.softening.active && residual >= 0.0 ? std::sin(residual * degree) : own.sin_phi;
  k.own.set(own);
  set_elasto_plastic_loops<MohrCoulomb>(k);
}

}  // namespace

namespace laws {
extern const MaterialLaw mohr_coulomb = {.name = "mohr_coulomb",
                                         .read = read,
                                         .set_constants = set_constants,
                                         .returned = elasto_plastic_return<MohrCoulomb>};
}

}  // namespace tailrun::mpm

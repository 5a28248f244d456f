// The rate equations of PM4Sand and PM4Silt: plastic modulus, dilatancy, fabric and loading index (Boulanger &
// Ziotopoulou 2017). Pure functions.
#pragma once

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

// Dilatancy D (volumetric plastic strain per plastic shear, contraction positive) as a function of p alone, everything
// else held: near p_min contraction fades out and dilation is enforced.
template <class Real>
struct Pm4DilatancyOf {
  using Condition = decltype(Real() < Real());
  Condition contraction{};
  Real free = 0.0;    // D away from p_min
  Real p_fade = 0.0;  // contraction: D = free * clip((p - 2 p_min)/p_fade, 0, 1)
  Real limit = 0.0;   // dilation: D <= -limit (2 p_min - p)/p_min for p <= 2 p_min
  Real two_p_min = 0.0;

  Real at(Real p_star) const {
    const Real contracting = free * clamp_to<Real>((p_star - two_p_min) / p_fade, 0.0, 1.0);
    const Real held = number::min(free, -2.0 * limit * (two_p_min - p_star) / two_p_min);
    return select(contraction, contracting, select(p_star > two_p_min, free, held));
  }
};

// What the flow rule and the hardening need, along one loading direction n.
template <class Real>
struct Pm4CoefficientsOf {
  Real B = 0.0;            // (alpha^b - alpha):n
  Real d = 0.0;            // (alpha^d - alpha):n
  Real H = 0.0;            // K_p = H sign(B) sqrt|B|
  Real fabric_rate = 0.0;  // dz = -fabric_rate L (z_max n + z)
  Pm4DilatancyOf<Real> dilatancy;
};
using Pm4Coefficients = Pm4CoefficientsOf<double>;

// Elastic change of stress over a strain increment (de carries 1/3 of the volumetric strain: dp = (K + G/3) de_v).
inline Pm4Variables elastic_change(const Pm4Moduli& moduli, const PlaneStrain& strain) {
  Pm4Variables change;
  change.p = (moduli.K + moduli.G / 3.0) * strain.volumetric;
  change.s = 2.0 * moduli.G * strain.deviator;
  return change;
}

// Where the rate equations are evaluated: a state, what belongs to it, and the unit direction n of loading.
template <class Real>
struct Pm4PlaceOf {
  const Pm4PointConstantsOf<Real>& point;
  const Pm4MemoryOf<Real>& memory;
  Real z_peak;
  const Pm4VariablesOf<Real>& v;
  const Pm4SurfacesOf<Real>& surfaces;
  const Pm4ModuliOf<Real>& moduli;
  DeviatorOf<Real> n;
};

// What the dilatancy shares with the plastic modulus.
template <class Real>
struct Pm4DirectionOf {
  Real p_star;   // max(p, p_min)
  Real alpha_n;  // alpha:n
  Real from_in;  // (alpha - alpha_in):n
  Real C_zpk2;
  Real per_z;  // 1/z_max
};

template <class Law, class Real>
inline void dilation(const Law& law, const Pm4PlaceOf<Real>& at, const Pm4DirectionOf<Real>& along, Real minus_zn,
                     Real C_zin1, Real d, Real d_rotated, Pm4DilatancyOf<Real>& out) {
  const Pm4PointConstantsOf<Real>& point = at.point;
  const Real z_cum = at.v.z_cum;
  const Real pressure = 2.5 * along.p_star / at.memory.p_zp;
  // 1/(C_pzp C_pmin) = resisting/scale
  Real resisting = 1.0 + square(square(pressure)) * pressure;
  Real scale = 1.0;
  if (Law::reduces_dilation_at_p_min) {
    scale = square(along.p_star);
    resisting *= scale + 100.0 * square(point.p_min);
  }
  // C_zin2 = (1 + t)/(1 + 3 t)
  const Real t = C_zin1 * (z_cum - at.z_peak) * along.per_z * (1.0 / 3.0);
  const Real fabric = square(z_cum) * along.per_z * cube(1.0 - sqrt_half * minus_zn / at.z_peak);
  const Real A_d = point.A_do * (1.0 + t) * resisting /
                   ((1.0 + 3.0 * t) * (fabric * point.C_eps_squared * C_zin1 * scale + resisting));
  const Real unrotated = A_d * d;
  const Real rotated = A_d * minus_zn * along.per_z * d_rotated * (sqrt_half / law.C_DR);
  const Real below = macaulay(at.surfaces.M_b - at.moduli.M_cur);
  out.free = select(unrotated > rotated, unrotated + (rotated - unrotated) * below / (below + 0.01), unrotated);
  out.limit = 3.5 * point.A_do * macaulay(at.surfaces.M_b - at.surfaces.M_d);
}

template <class Law, class Real>
inline void contraction(const Law& law, const Pm4PlaceOf<Real>& at, const Pm4DirectionOf<Real>& along, Real z_plus,
                        Real B, Real d, Pm4DilatancyOf<Real>& out) {
  const Pm4PointConstantsOf<Real>& point = at.point;
  const Real h_p = law.h_po * number::exp(-0.7 + Law::h_p_slope * square(macaulay(Law::h_p_origin - at.surfaces.xi)));
  const Real C_rot2 = 1.0 - along.C_zpk2;
  Real C_dz = (point.z_max - C_rot2 * sqrt_two * at.z_peak) / (point.z_max + C_rot2 * at.v.z_cum);
  if constexpr (Law::limits_contraction_fabric) C_dz = number::max(C_dz, 1.0 / (1.0 + 0.5 * point.z_max));
  Real softening = h_p * C_dz;
  if constexpr (Law::wet_contraction) softening *= law.wet_factor(B, at.surfaces.xi);
  const Real A_dc = point.A_do * (1.0 + z_plus) / softening;
  const Real path = along.from_in + sqrt_two * z_plus * along.per_z;
  out.free = number::min(A_dc * square(path), Law::contraction_cap * point.A_do) * d / (d + Law::C_D);
}

template <class Law, class Real>
inline Pm4DilatancyOf<Real> dilatancy(const Law& law, const Pm4PlaceOf<Real>& at, const Pm4DirectionOf<Real>& along,
                                      Real B, Real d) {
  const Pm4PointConstantsOf<Real>& point = at.point;
  Pm4DilatancyOf<Real> out;
  out.two_p_min = 2.0 * point.p_min;
  out.p_fade = Law::p_min_width * point.p_min;
  const Real z_n = contract(at.v.z, at.n);
  const Real minus_zn = macaulay(-z_n);
  const Real z_change = number::abs(contract(at.memory.z_in, at.n) - z_n);
  // (alpha^dR - alpha):n; n:n = 1, so it needs no tensor. Before any fabric has formed, the plain one.
  Real C_zin1 = 0.0;
  Real d_rotated = d;
  if (any(z_change > 0.0)) C_zin1 = 1.0 - number::exp(-2.0 * z_change * along.per_z);
  if (any(minus_zn > 0.0)) {
    const Real C_rot1 = 1.0 + sqrt_two * minus_zn * along.per_z * (1.0 - C_zin1);
    d_rotated = sqrt_half * (at.surfaces.M_d / C_rot1 - law.m) - along.alpha_n;
  }
  out.contraction = d_rotated > 0.0;
  if (any(!out.contraction)) dilation(law, at, along, minus_zn, C_zin1, d, d_rotated, out);
  if (any(out.contraction)) {
    Pm4DilatancyOf<Real> contracting;
    contraction(law, at, along, macaulay(z_n), B, d, contracting);
    out.free = select(out.contraction, contracting.free, out.free);
  }
  return out;
}

// Everything along the unit direction n at the state v. Quotients share their divisions, which is where the time goes.
template <class Law, class Real>
inline Pm4CoefficientsOf<Real> coefficients(const Law& law, const Pm4PlaceOf<Real>& at) {
  Pm4CoefficientsOf<Real> out;
  const Pm4PointConstantsOf<Real>& point = at.point;
  const Pm4MemoryOf<Real>& memory = at.memory;
  const Real z_cum = at.v.z_cum;
  Pm4DirectionOf<Real> along;
  along.p_star = number::max(at.v.p, point.p_min);
  along.alpha_n = contract(at.v.alpha, at.n);
  along.from_in = along.alpha_n - contract(deviator(memory.alpha_in), at.n);
  along.C_zpk2 = number::min(at.z_peak / (z_cum + 0.01 * point.z_max), Real(1.0 - 1e-10));
  along.per_z = 1.0 / point.z_max;
  out.B = sqrt_half * (at.surfaces.M_b - law.m) - along.alpha_n;
  out.d = sqrt_half * (at.surfaces.M_d - law.m) - along.alpha_n;

  // H = G h_0 C_rev C_Ka/[(exp(A_app) - 1 + C_gamma1) (1 + 2 (z_peak/z_max) <B> sqrt(1 - C_zpk2))]
  const Real A_app = macaulay(along.from_in);
  const Real A_true = macaulay(along.alpha_n - contract(memory.alpha_in_true, at.n));
  const auto small_reversal = along.alpha_n - contract(memory.alpha_in_previous, at.n) <= 0.0;
  const Real above = macaulay(memory.p_zp - along.p_star);
  // C_Ka - 1 = C_Kaf C_pzp2 C_zpk1/[1 + (2.5 A_true)^2] with C_pzp2 = <p_zp - p>/(<p_zp - p> + p_min),
  // C_zpk1 = z_peak/(z_cum + z_max/5)
  const Real below_Ka = (1.0 + square(2.5 * A_true)) * (above + point.p_min) * (z_cum + 0.2 * point.z_max);
  const Real over_Ka = below_Ka + law.C_Kaf * above * at.z_peak;
  const Real over_rev = select(small_reversal, A_app + law.C_gamma1, Real(1.0));
  const Real below_rev = select(small_reversal, A_true + law.C_gamma1, Real(1.0));
  const Real fabric_term = 1.0 + 2.0 * at.z_peak * along.per_z * macaulay(out.B) * number::sqrt(1.0 - along.C_zpk2);
  const Real path_term = number::exp(A_app) - 1.0 + law.C_gamma1;
  out.H = at.moduli.G * law.h0 * over_rev * over_Ka / (below_rev * below_Ka * path_term * fabric_term);
  out.dilatancy = dilatancy(law, at, along, out.B, out.d);
  const Real rate = law.c_z / (1.0 + macaulay(0.5 * z_cum * along.per_z - 1.0));
  out.fabric_rate = select(out.d < 0.0, rate, Real(0.0));
  return out;
}

struct Pm4Rates {
  Pm4Variables change;  // of the variables over the strain increment
  double L = 0.0;       // loading index; negative means the increment is elastic
  double D = 0.0;
  double K_p = 0.0;
  double denominator = 0.0;
  Deviator n;
};

// Change of the variables over a strain increment, everything evaluated at `v`. `surfaces` and `moduli` are the
// caller's because OpenSees evaluates the moduli once per piece.
template <class Law>
inline Pm4Rates rates(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory, double z_peak,
                      const Pm4Variables& v, const Pm4Surfaces& surfaces, const Pm4Moduli& moduli,
                      const PlaneStrain& strain) {
  Pm4Rates out;
  const double p_star = std::max(v.p, point.p_min);
  const double G = moduli.G;
  const double K = moduli.K;
  const Deviator n = cone_normal(v.p, v.s, v.alpha);
  out.n = n;
  const Pm4Coefficients c = coefficients(law, Pm4PlaceOf<double>{point, memory, z_peak, v, surfaces, moduli, n});
  const bool flat = std::fabs(c.B) < 1e-10;
  out.K_p = flat ? 0.0 : c.H * std::copysign(std::sqrt(std::fabs(c.B)), c.B);
  const double hardening = flat ? 0.0 : out.K_p / (p_star * c.B);
  out.D = c.dilatancy.at(p_star);
  // The published loading index has no softening in contraction; the hardening rule above keeps its own K_p.
  if (c.dilatancy.contraction) out.K_p = macaulay(out.K_p);

  const double n_r = contract(n, v.s) / v.p;
  out.denominator = out.K_p + 2.0 * G - K * out.D * n_r;
  if (std::fabs(out.denominator) < 1e-10 * law.atmospheric_pressure) return out;
  out.L = (2.0 * G * contract(n, strain.deviator) - n_r * K * strain.volumetric) / out.denominator;
  out.change = elastic_change(moduli, strain);
  if (out.L < 0.0) return out;
  out.change.p -= out.L * K * out.D;
  out.change.s = out.change.s - 2.0 * G * out.L * n;
  const Deviator b = sqrt_half * (surfaces.M_b - law.m) * n - v.alpha;
  out.change.alpha = out.L * hardening * b;
  if (out.D < 0.0) out.change.z = -out.L * c.fabric_rate * (point.z_max * n + v.z);
  return out;
}

}  // namespace tailrun::fem

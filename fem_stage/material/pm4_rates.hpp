// The rate equations of PM4Sand and PM4Silt: plastic modulus, dilatancy, fabric and loading index (Boulanger &
// Ziotopoulou 2017). Pure functions.
#pragma once

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

// Dilatancy D (volumetric plastic strain per plastic shear, contraction positive) as a function of p alone, everything
// else held: near p_min contraction fades out and dilation is enforced.
struct Pm4Dilatancy {
  bool contraction = false;
  double free = 0.0;    // D away from p_min
  double p_fade = 0.0;  // contraction: D = free * clip((p - 2 p_min)/p_fade, 0, 1)
  double limit = 0.0;   // dilation: D <= -limit (2 p_min - p)/p_min for p <= 2 p_min
  double two_p_min = 0.0;

  double at(double p_star) const {
    if (contraction) return free * std::clamp((p_star - two_p_min) / p_fade, 0.0, 1.0);
    if (p_star > two_p_min) return free;
    return std::min(free, -2.0 * limit * (two_p_min - p_star) / two_p_min);
  }
};

// What the flow rule and the hardening need, along one loading direction n.
struct Pm4Coefficients {
  double B = 0.0;            // (alpha^b - alpha):n
  double d = 0.0;            // (alpha^d - alpha):n
  double H = 0.0;            // K_p = H sign(B) sqrt|B|
  double fabric_rate = 0.0;  // dz = -fabric_rate L (z_max n + z)
  Pm4Dilatancy dilatancy;
};

// Elastic change of stress over a strain increment (de carries 1/3 of the volumetric strain: dp = (K + G/3) de_v).
inline Pm4Variables elastic_change(const Pm4Moduli& moduli, const PlaneStrain& strain) {
  Pm4Variables change;
  change.p = (moduli.K + moduli.G / 3.0) * strain.volumetric;
  change.s = 2.0 * moduli.G * strain.deviator;
  return change;
}

template <class Law>
inline Pm4Dilatancy dilatancy(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory, double z_peak,
                              const Pm4Variables& v, const Pm4Surfaces& surfaces, double M_cur, double p_star,
                              Deviator n, double B, double d, double C_zpk2) {
  Pm4Dilatancy out;
  out.two_p_min = 2.0 * point.p_min;
  const double z_n = contract(v.z, n);
  const double minus_zn = macaulay(-z_n);
  const double C_zin1 = 1.0 - std::exp(-2.0 * std::fabs(contract(memory.z_in, n) - z_n) / point.z_max);
  const double C_rot1 = std::max(1.0, 1.0 + sqrt_two * minus_zn / point.z_max * (1.0 - C_zin1));
  // n:n = 1, so (alpha^dR - alpha):n needs no tensor.
  const double alpha_n = contract(v.alpha, n);
  const double d_rotated = sqrt_half * (surfaces.M_d / C_rot1 - law.m) - alpha_n;
  if (d_rotated <= 0.0) {
    const double pressure = 2.5 * p_star / memory.p_zp;
    const double C_pzp = 1.0 / (1.0 + square(square(pressure)) * pressure);
    const double C_pmin = Law::reduces_dilation_at_p_min ? 1.0 / (1.0 + square(10.0 * point.p_min / p_star)) : 1.0;
    const double t = C_zin1 * (v.z_cum - z_peak) / (3.0 * point.z_max);
    const double C_zin2 = (1.0 + t) / (1.0 + 3.0 * t);
    const double fabric = v.z_cum * v.z_cum / point.z_max * cube(1.0 - minus_zn / (sqrt_two * z_peak));
    const double A_d = point.A_do * C_zin2 / (fabric * point.C_eps_squared * C_pzp * C_pmin * C_zin1 + 1.0);
    out.free = A_d * d;
    const double D_rot = A_d * minus_zn / (sqrt_two * point.z_max) * d_rotated / law.C_DR;
    if (out.free > D_rot) {
      const double below = macaulay(surfaces.M_b - M_cur);
      out.free += (D_rot - out.free) * below / (below + 0.01);
    }
    out.limit = 3.5 * point.A_do * macaulay(surfaces.M_b - surfaces.M_d);
    return out;
  }
  out.contraction = true;
  out.p_fade = Law::p_min_width * point.p_min;
  const double h_p = law.h_po * std::exp(-0.7 + Law::h_p_slope * square(macaulay(Law::h_p_origin - surfaces.xi)));
  const double C_rot2 = 1.0 - C_zpk2;
  double C_dz = (1.0 - C_rot2 * sqrt_two * z_peak / point.z_max) * point.z_max / (point.z_max + C_rot2 * v.z_cum);
  if constexpr (Law::limits_contraction_fabric) C_dz = std::max(C_dz, 1.0 / (1.0 + 0.5 * point.z_max));
  double softening = h_p * C_dz;
  if constexpr (Law::wet_contraction) softening *= law.wet_factor(B, surfaces.xi);
  const double z_plus = macaulay(z_n);
  const double A_dc = point.A_do * (1.0 + z_plus) / softening;
  const double path = alpha_n - contract(deviator(memory.alpha_in), n) + sqrt_two * z_plus / point.z_max;
  out.free = std::min(A_dc * square(path), Law::contraction_cap * point.A_do) * d / (d + Law::C_D);
  return out;
}

// Everything along the unit direction n at the state v. G: shear modulus; M_cur: q/p*.
template <class Law>
inline Pm4Coefficients coefficients(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory,
                                    double z_peak, const Pm4Variables& v, const Pm4Surfaces& surfaces,
                                    const Pm4Moduli& moduli, Deviator n) {
  Pm4Coefficients out;
  const double p_star = std::max(v.p, point.p_min);
  const double alpha_n = contract(v.alpha, n);
  out.B = sqrt_half * (surfaces.M_b - law.m) - alpha_n;
  out.d = sqrt_half * (surfaces.M_d - law.m) - alpha_n;

  const double C_zpk1 = z_peak / (v.z_cum + 0.2 * point.z_max);
  const double C_zpk2 = std::min(z_peak / (v.z_cum + 0.01 * point.z_max), 1.0 - 1e-10);
  const double A_app = macaulay(alpha_n - contract(deviator(memory.alpha_in), n));
  const double A_true = macaulay(alpha_n - contract(memory.alpha_in_true, n));
  const double above = macaulay(memory.p_zp - p_star);
  const double C_pzp2 = above / (above + point.p_min);
  const double C_Ka = 1.0 + law.C_Kaf / (1.0 + square(2.5 * A_true)) * C_pzp2 * C_zpk1;
  const bool small_reversal = alpha_n - contract(memory.alpha_in_previous, n) <= 0.0;
  const double C_rev = small_reversal ? (A_app + law.C_gamma1) / (A_true + law.C_gamma1) : 1.0;
  const double fabric_term = 1.0 + 2.0 * (z_peak / point.z_max) * macaulay(out.B) * std::sqrt(1.0 - C_zpk2);
  out.H = moduli.G * law.h0 * C_rev * C_Ka / ((std::exp(A_app) - 1.0 + law.C_gamma1) * fabric_term);
  out.dilatancy = dilatancy(law, point, memory, z_peak, v, surfaces, moduli.M_cur, p_star, n, out.B, out.d, C_zpk2);
  if (out.d < 0.0) out.fabric_rate = law.c_z / (1.0 + macaulay(0.5 * v.z_cum / point.z_max - 1.0));
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
  const Pm4Coefficients c = coefficients(law, point, memory, z_peak, v, surfaces, moduli, n);
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

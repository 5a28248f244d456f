// The rate equations of PM4Sand and PM4Silt: plastic modulus, dilatancy, fabric and loading index (Boulanger &
// Ziotopoulou 2017). Pure functions; every stage of every integrator goes through `rates`.
#pragma once

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

struct Pm4Rates {
  Pm4Variables change;  // of the variables over the strain increment
  double L = 0.0;       // loading index; negative means the increment is elastic
  double D = 0.0;       // dilatancy
  double K_p = 0.0;     // plastic modulus
  double denominator = 0.0;
  Deviator n;
};

// Elastic change of stress over a strain increment (de carries 1/3 of the volumetric strain: dp = (K + G/3) de_v).
inline Pm4Variables elastic_change(const Pm4Moduli& moduli, const PlaneStrain& strain) {
  Pm4Variables change;
  change.p = (moduli.K + moduli.G / 3.0) * strain.volumetric;
  change.s = 2.0 * moduli.G * strain.deviator;
  return change;
}

// Plastic modulus K_p, and `hardening` = K_p/(p B), so that d alpha = L hardening b.
template <class Law>
inline double plastic_modulus(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory, double z_peak,
                              const Pm4Variables& v, double p_star, double G, Deviator n, double B, double C_zpk1,
                              double C_zpk2, double A_app, double A_true) {
  const double above = macaulay(memory.p_zp - p_star);
  const double C_pzp2 = above / (above + point.p_min);
  const double C_Ka = 1.0 + law.C_Kaf / (1.0 + square(2.5 * A_true)) * C_pzp2 * C_zpk1;
  const bool small_reversal = contract(v.alpha - memory.alpha_in_previous, n) <= 0.0;
  const double C_rev = small_reversal ? (A_app + law.C_gamma1) / (A_true + law.C_gamma1) : 1.0;
  const double root_B = std::copysign(std::sqrt(std::fabs(B)), B);
  const double fabric_term = 1.0 + 2.0 * (z_peak / point.z_max) * macaulay(B) * std::sqrt(1.0 - C_zpk2);
  return G * law.h0 * root_B * C_rev * C_Ka / ((std::exp(A_app) - 1.0 + law.C_gamma1) * fabric_term);
}

// Dilatancy D; clears the sign of K_p for contraction, as the published model does in its loading index.
template <class Law>
inline double dilatancy(const Law& law, const Pm4PointConstants& point, const Pm4Memory& memory, double z_peak,
                        const Pm4Variables& v, const Pm4Surfaces& surfaces, double M_cur, double p_star, Deviator n,
                        double B, double d, double C_zpk2, double& K_p) {
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
    double D = A_d * d;
    const double D_rot = A_d * minus_zn / (sqrt_two * point.z_max) * d_rotated / law.C_DR;
    if (D > D_rot) {
      const double below = macaulay(surfaces.M_b - M_cur);
      D += (D_rot - D) * below / (below + 0.01);
    }
    if (p_star <= 2.0 * point.p_min) {
      const double limit =
          -3.5 * point.A_do * macaulay(surfaces.M_b - surfaces.M_d) * (2.0 * point.p_min - p_star) / point.p_min;
      D = std::min(D, limit);
    }
    return D;
  }
  K_p = macaulay(K_p);
  const double h_p = law.h_po * std::exp(-0.7 + Law::h_p_slope * square(macaulay(Law::h_p_origin - surfaces.xi)));
  const double C_rot2 = 1.0 - C_zpk2;
  double C_dz = (1.0 - C_rot2 * sqrt_two * z_peak / point.z_max) * point.z_max / (point.z_max + C_rot2 * v.z_cum);
  if constexpr (Law::limits_contraction_fabric) C_dz = std::max(C_dz, 1.0 / (1.0 + 0.5 * point.z_max));
  double softening = h_p * C_dz;
  if constexpr (Law::wet_contraction) softening *= law.wet_factor(B, surfaces.xi);
  const double z_plus = macaulay(z_n);
  const double A_dc = point.A_do * (1.0 + z_plus) / softening;
  const double path = alpha_n - contract(deviator(memory.alpha_in), n) + sqrt_two * z_plus / point.z_max;
  const double D = std::min(A_dc * square(path), Law::contraction_cap * point.A_do) * d / (d + Law::C_D);
  return D * std::clamp((p_star - 2.0 * point.p_min) / (Law::p_min_width * point.p_min), 0.0, 1.0);
}

// Change of the variables over a (sub-)step's strain increment with everything evaluated at `v`. `surfaces` and
// `moduli` are the caller's because OpenSees evaluates the moduli once per piece and others at every stage.
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
  const Deviator b = sqrt_half * (surfaces.M_b - law.m) * n - v.alpha;
  const double B = contract(b, n);
  const double d = sqrt_half * (surfaces.M_d - law.m) - contract(v.alpha, n);

  const double C_zpk1 = z_peak / (v.z_cum + 0.2 * point.z_max);
  const double C_zpk2 = std::min(z_peak / (v.z_cum + 0.01 * point.z_max), 1.0 - 1e-10);
  const double A_app = macaulay(contract(v.alpha - deviator(memory.alpha_in), n));
  const double A_true = macaulay(contract(v.alpha - memory.alpha_in_true, n));
  const bool flat = std::fabs(B) < 1e-10;
  double K_p =
      flat ? 0.0 : plastic_modulus(law, point, memory, z_peak, v, p_star, G, n, B, C_zpk1, C_zpk2, A_app, A_true);
  const double hardening = flat ? 0.0 : K_p / (p_star * B);
  out.D = dilatancy(law, point, memory, z_peak, v, surfaces, moduli.M_cur, p_star, n, B, d, C_zpk2, K_p);
  out.K_p = K_p;

  const double n_r = contract(n, v.s) / v.p;
  out.denominator = K_p + 2.0 * G - K * out.D * n_r;
  if (std::fabs(out.denominator) < 1e-10 * law.atmospheric_pressure) return out;
  // The published numerator has K although dp = (K + G/3) de_v, so f would not stay 0. Where the rest, n:r (G/3) de_v,
  // sinks the stress into the cone, the limit of ever smaller steps is a numerator with K + G/3; where it pushes the
  // stress out, OpenSees' yield correction moves alpha on towards the bounding surface by what is missing. The improved
  // mode integrates these limits; the compatible one leaves them to the correction itself.
  double K_n = K;
  double extra_hardening = 0.0;
  if (law.compatibility == Pm4Compatibility::improved) {
    const double outward = -n_r * G / 3.0 * strain.volumetric;
    if (outward <= 0.0 || B < 1e-3) {
      K_n = K + G / 3.0;
    } else {
      extra_hardening = outward / (p_star * B);
    }
  }
  out.L = (2.0 * G * contract(n, strain.deviator) - n_r * K_n * strain.volumetric) / out.denominator;
  out.change = elastic_change(moduli, strain);
  if (out.L < 0.0) return out;
  out.change.p -= out.L * K * out.D;
  out.change.s = out.change.s - 2.0 * G * out.L * n;
  out.change.alpha = (out.L * hardening + extra_hardening) * b;
  if (out.D < 0.0 && d < 0.0) {
    const double rate = law.c_z * out.L / (1.0 + macaulay(0.5 * v.z_cum / point.z_max - 1.0));
    out.change.z = -rate * (point.z_max * n + v.z);
    out.change.z_cum = 0.5 * norm(out.change.z) * sqrt_two;
  }
  return out;
}

}  // namespace tailrun::fem

// PM4Sand version 3.1 (Boulanger & Ziotopoulou 2017, report UCD/CGM-17/01), plane strain, effective stress.
#pragma once

#include <limits>

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

// NaN stands for "use the default given on the right".
struct Pm4SandParameters {
  static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  //                                       symbol      unit    default                                  admissible
  double relative_density = unset;        // D_R         1       required                                 (0, 1.2)
  double shear_coefficient = unset;       // G_0         1       167 sqrt(46 D_R^2 + 2.5)                 > 0
  double contraction_rate = unset;        // h_po        1       required (calibrated)                    > 0
  double density = unset;                 // rho         kg/m3   required (saturated bulk density)        > 0
  double atmospheric_pressure = 101.3e3;  // p_A       Pa      101300                                   > 0
  double hardening_ratio = unset;         // h_0         1       max(0.30, (0.25 + D_R)/2)                > 0
  double e_max = 0.8;                     // e_max       1       0.8                                      > e_min
  double e_min = 0.5;                     // e_min       1       0.5                                      > 0
  double n_b = 0.5;                       // n_b         1       0.5                                      >= 0
  double n_d = 0.1;                       // n_d         1       0.1                                      >= 0
  double A_do = unset;                    // A_do        1       from M_b, M_d at initialisation          > 0
  double z_max = unset;                   // z_max       1       min(0.7 exp(-6.1 xi_R0), 20)             > 0
  double c_z = 250.0;                     // c_z         1       250                                      >= 0
  double C_epsilon = unset;               // C_eps       1       0.5 (D_R <= .55) ... 0.2 (D_R >= .75)    > 0
  double phi_cv = 33.0;                   // phi_cv      deg     33                                       (0, 60)
  double poisson = 0.3;                   // nu          1       0.3                                      [0, 0.5]
  double C_GD = 2.0;                      // C_GD        1       2.0                                      >= 1
  double C_DR = unset;                    // C_DR        1       min(5 + 25 (D_R - .35), 10)              > 0
  double C_Kaf = unset;                   // C_Kalphaf   1       5 + 220 (D_R - .26)^3 in [4, 35]         >= 0
  double Q = 10.0;                        // Q           1       10                                       > 0
  double R = 1.5;                         // R           1       1.5                                      > 0
  double m = 0.01;                        // m           1       0.01 (cone radius)                       (0, 0.1]
  double F_sed_min = unset;               // F_sed,min   1       min(0.03 exp(2.6 D_R), 0.99)             (0, 1]
  double p_sed_o = unset;                 // p_sed,o     Pa      p_A/5                                    > 0
  Pm4Compatibility compatibility = Pm4Compatibility::improved;
  Pm4BoundingClip bounding_clip = Pm4BoundingClip::always;
};

// The resolved material and the functions in which it differs from PM4Silt.
struct Pm4SandLaw : Pm4Law {
  static constexpr double contraction_cap = 1.5;  // largest contraction rate is this times A_do
  static constexpr double C_D = 0.16;
  static constexpr double p_min_width = 16.0;              // contraction fades between 2 p_min and (2 + this) p_min
  static constexpr bool limits_contraction_fabric = true;  // C_dz >= 1/(1 + z_max/2)
  static constexpr bool reduces_dilation_at_p_min = true;  // C_pmin
  static constexpr bool wet_contraction = false;           // C_wet
  static constexpr double h_p_slope = 7.0;
  static constexpr double h_p_origin = 0.5;
  static constexpr bool apparent_ratio_starts_at_alpha = false;

  Pm4SandParameters given;
  double n_b_dense = 0.0, n_b_loose = 0.0, n_d_dense = 0.0, n_d_loose = 0.0;
  double Q_shifted = 0.0;  // Q - ln(100/p_A), so that xi_R = R/(Q_shifted - ln p) - D_R
  double R = 0.0;
  double modulus_factor = 0.0;
  double C_eps_squared = 0.0;
  double F_sed_min = 0.0;
  double p_sed_o = 0.0;

  // xi_R, M_b, M_d at p* (already >= p_min) and the current relative density.
  template <class Real>
  Pm4SurfacesOf<Real> surfaces(const Pm4PointConstantsOf<Real>&, Real p_star, Real relative_density) const {
    Pm4SurfacesOf<Real> out;
    // Bolton's expression has a pole at the crushing pressure (p_A e^Q/100, tens of MPa): stop short of it.
    out.xi = R / number::max(Q_shifted - number::log(p_star), Real(0.5)) - relative_density;
    const auto loose = out.xi > 0.0;
    out.M_b = M * number::exp(-select(loose, Real(n_b_loose), Real(n_b_dense)) * out.xi);
    out.M_d = M * number::exp(select(loose, Real(n_d_loose), Real(n_d_dense)) * out.xi);
    return out;
  }
  template <class Real>
  Real modulus_at(Real p_star) const {
    return modulus_factor * number::sqrt(p_star);
  }
  template <class Real>
  Real post_shaking_factor(const Pm4PointConstantsOf<Real>& point, const Pm4SurfacesOf<Real>& surfaces,
                           const Pm4ModuliOf<Real>& moduli, Real p_star, Real z_cum) const {
    const Real below_dilatancy = macaulay(1.0 - moduli.M_cur / surfaces.M_d);
    const Real p_sed = p_sed_o * z_cum / (z_cum + point.z_max) * number::sqrt(number::sqrt(below_dilatancy));
    const Real factor = number::min(Real(1.0), F_sed_min + (1.0 - F_sed_min) * p_star / (20.0 * p_sed));
    return select(p_sed > 0.0, factor, Real(1.0));
  }
};

// Defaults filled in. The parameters must be in their ranges (read_material checks them).
Pm4SandLaw resolve(const Pm4SandParameters& parameters);

// The constants of a point that starts from the mean stress p0 and the vertical effective stress (compression
// positive): p_min always; A_do and z_max (unless they are parameters) from p0 and the input relative density when
// `recompute`.
void set_initial_constants(const Pm4SandLaw& law, double p0, double vertical_stress, bool recompute,
                           Pm4PointConstants& point);

}  // namespace tailrun::fem

// PM4Silt version 1 (Boulanger & Ziotopoulou 2018, report UCD/CGM-18/01), plane strain: low-plasticity silts and clays
// whose undrained critical-state strength is a parameter. What it shares with PM4Sand is in pm4_law, pm4_rates,
// pm4_memory and the integrators.
#pragma once

#include <limits>

#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

// NaN stands for "use the default given on the right". One of the two strengths must be given; the absolute one wins.
struct Pm4SiltParameters {
  static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  //                                       symbol           unit    default                                admissible
  double strength = unset;                // S_u,cs           Pa      strength_ratio sigma'_v0               > 0
  double strength_ratio = unset;          // S_u,cs/sigma'_v0 1       strength/sigma'_v0                     > 0
  double strength_reduction = 1.0;        // F_su             1       1                                      > 0
  double shear_coefficient = unset;       // G_0              1       required                               > 0
  double contraction_rate = unset;        // h_po             1       required (calibrated)                  > 0
  double density = unset;                 // rho              kg/m3   required                               > 0
  double atmospheric_pressure = 101.3e3;  // p_A            Pa      101300                                 > 0
  double modulus_exponent = 0.75;         // n_G              1       0.75                                   [0, 1]
  double hardening_ratio = 0.5;           // h_0              1       0.5                                    > 0
  double void_ratio = 0.90;               // e_0              1       0.90                                   > 0
  double lambda = 0.060;                  // lambda           1       0.060 (CSL slope in e - ln p)          > 0
  double phi_cv = 32.0;                   // phi_cv           deg     32                                     (0, 60)
  double n_b_wet = 0.8;                   // n_b,wet          1       0.8                                    [0.01, 1]
  double n_b_dry = 0.5;                   // n_b,dry          1       0.5                                    > 0
  double n_d = 0.3;                       // n_d              1       0.3                                    >= 0
  double A_do = 0.8;                      // A_do             1       0.8                                    > 0
  double r_u_max = unset;                 // r_u,max          1       none: p_min = p_cs/8                   [0, 1)
  double z_max = unset;                   // z_max            1       10 ... 20 with the strength ratio      > 0
  double c_z = 100.0;                     // c_z              1       100                                    >= 0
  double C_epsilon = unset;               // C_eps            1       min(1.3, 0.5 + 1.2<S_u/s_v - 0.25>)    > 0
  double C_GD = 3.0;                      // C_GD             1       3.0                                    >= 1
  double C_Kaf = 4.0;                     // C_Kalphaf        1       4.0                                    >= 0
  double poisson = 0.3;                   // nu               1       0.3                                    [0, 0.5]
  double m = 0.01;                        // m                1       0.01                                   (0, 0.1]
  double C_G_consolidation = 2.0;         // C_Gconsol        1       2.0                                    >= 1
  double phi_b_max = 60.0;  // phi_b,max        deg     60: M_b,max = 2 sin phi_b,max          (phi_cv, 90)
  Pm4Compatibility compatibility = Pm4Compatibility::improved;
  Pm4BoundingClip bounding_clip = Pm4BoundingClip::always;
};

struct Pm4SiltLaw : Pm4Law {
  static constexpr double contraction_cap = 1.0;
  static constexpr double C_D = 0.10;
  static constexpr double p_min_width = 6.0;
  static constexpr bool limits_contraction_fabric = false;
  static constexpr bool reduces_dilation_at_p_min = false;
  static constexpr bool wet_contraction = true;
  static constexpr double h_p_slope = 0.2;
  static constexpr double h_p_origin = 3.0;
  static constexpr bool apparent_ratio_starts_at_alpha = true;

  Pm4SiltParameters given;
  double inverse_lambda = 0.0;
  double log_F_su = 0.0;
  double C_Mb = 0.0;
  double modulus_factor = 0.0;

  // xi_s = xi/lambda, M_b, M_d at p* and the current void ratio.
  template <class Real>
  Pm4SurfacesOf<Real> surfaces(const Pm4PointConstantsOf<Real>& point, Real p_star, Real void_ratio) const {
    Pm4SurfacesOf<Real> out;
    const Real relative = p_star / point.p_cs;
    out.xi = (void_ratio - given.void_ratio) * inverse_lambda + number::log(relative) - log_F_su;
    out.M_b = select(out.xi >= 0.0, M * number::exp(-given.n_b_wet * out.xi),
                     M * number::pow((1.0 + C_Mb) / (relative + C_Mb), given.n_b_dry));
    out.M_d = number::min(Real(sqrt_two), M * number::exp(given.n_d * out.xi));
    return out;
  }
  template <class Real>
  Real modulus_at(Real p_star) const {
    return modulus_factor * number::pow(p_star, given.modulus_exponent);
  }
  // C_wet: loose of critical, contraction rises near the bounding surface so that the state moves on to critical.
  template <class Real>
  Real wet_factor(Real B, Real xi) const {
    const Real near = 0.02 / B;
    return number::min(Real(1.0), 1.0 / (1.0 + square(square(near))) + 1.0 / (1.0 + square(10.0 * xi)));
  }
  template <class Real>
  Real post_shaking_factor(const Pm4PointConstantsOf<Real>& point, const Pm4SurfacesOf<Real>& surfaces,
                           const Pm4ModuliOf<Real>& moduli, Real p_star, Real z_cum) const {
    const Real below_dilatancy = macaulay(1.0 - moduli.M_cur / surfaces.M_d);
    const Real G_min =
        8.0 * p_star * inverse_lambda / (1.0 + (given.C_G_consolidation - 1.0) * z_cum / (z_cum + point.z_max));
    return 1.0 - (1.0 - G_min / moduli.G) * number::sqrt(number::sqrt(below_dilatancy));
  }
};

// Defaults filled in. The parameters must be in their ranges (read_material checks them).
Pm4SiltLaw resolve(const Pm4SiltParameters& parameters);

// p_min, p_cs, z_max and C_eps of a point that starts from mean stress p0 and the vertical effective stress
// (compression positive). Strength and fabric constants are kept unless `recompute`.
void set_initial_constants(const Pm4SiltLaw& law, double p0, double vertical_stress, bool recompute,
                           Pm4PointConstants& point);

}  // namespace tailrun::fem

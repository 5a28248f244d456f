// PM4Silt version 1 (Boulanger & Ziotopoulou 2018, report UCD/CGM-18/01), plane strain: low-plasticity silts and clays
// whose undrained critical-state strength is a parameter. What it shares with PM4Sand is in pm4_law, pm4_rates,
// pm4_memory and the integrators.
#pragma once

#include "fem_stage/material/material_keys.hpp"
#include "fem_stage/material/pm4_points.hpp"

namespace tailrun::fem {

struct Pm4SiltLaw;

// Where a number stays unset, set_initial_constants() uses what is on the right. One of the two strengths is given; the
// absolute one wins. Units and ranges are in read(), pm4_keys.hpp has those that PM4Sand shares.
struct Pm4SiltParameters {
  static constexpr std::string_view model_name = "pm4silt";
  using Points = Pm4Points<Pm4SiltLaw>;

  double strength = unset;                // S_u,cs: strength_ratio sigma'_v0
  double strength_ratio = unset;          // S_u,cs/sigma'_v0
  double strength_reduction = 1.0;        // F_su
  double shear_coefficient = unset;       // G_0
  double contraction_rate = unset;        // h_po, calibrated
  double density = unset;                 // rho of the saturated soil
  double atmospheric_pressure = 101.3e3;  // p_A
  double modulus_exponent = 0.75;         // n_G
  double hardening_ratio = 0.5;           // h_0
  double void_ratio = 0.90;               // e_0
  double lambda = 0.060;                  // slope of the critical state line in e - ln p
  double phi_cv = 32.0;                   // friction angle at critical state
  double n_b_wet = 0.8;                   // exponents of the bounding surface, loose and dense of critical
  double n_b_dry = 0.5;
  double n_d = 0.3;                // of the dilatancy surface
  double A_do = 0.8;               // dilatancy
  double r_u_max = unset;          // limits p_min, which is p_cs/8
  double z_max = unset;            // fabric limit: 10 to 20 with the strength ratio
  double c_z = 100.0;              // fabric growth
  double C_epsilon = unset;        // strain accumulation: min(1.3, 0.5 + 1.2 <S_u/s_v - 0.25>)
  double C_GD = 3.0;               // G falls to 1/C_GD with fabric
  double C_Kaf = 4.0;              // static shear and fabric in K_p
  double poisson = 0.3;            // nu
  double m = 0.01;                 // radius of the yield cone
  double C_G_consolidation = 2.0;  // reconsolidation
  double phi_b_max = 60.0;         // M_b,max = 2 sin phi_b,max
  Pm4Compatibility compatibility = Pm4Compatibility::improved;
  Pm4BoundingClip bounding_clip = Pm4BoundingClip::always;

  static Pm4SiltParameters read(const CaseNode& node);
  double porosity() const { return void_ratio / (1.0 + void_ratio); }
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

// Defaults filled in. The parameters must be in their ranges (read() checks them).
Pm4SiltLaw resolve(const Pm4SiltParameters& parameters);

// p_min, p_cs, z_max and C_eps of a point that starts from mean stress p0 and the vertical effective stress
// (compression positive). Strength and fabric constants are kept unless `recompute`.
void set_initial_constants(const Pm4SiltLaw& law, double p0, double vertical_stress, bool recompute,
                           Pm4PointConstants& point);

}  // namespace tailrun::fem

// PM4Sand version 3.1 (Boulanger & Ziotopoulou 2017, report UCD/CGM-17/01), plane strain, effective stress.
#pragma once

#include "fem_stage/material/material_keys.hpp"
#include "fem_stage/material/pm4_points.hpp"

namespace tailrun::fem {

struct Pm4SandLaw;

// Where a number stays unset, resolve() and set_initial_constants() use what is on the right. Units and ranges are in
// read(), pm4_keys.hpp has those that PM4Silt shares.
struct Pm4SandParameters {
  static constexpr std::string_view model_name = "pm4sand";
  using Points = Pm4Points<Pm4SandLaw>;

  double relative_density = unset;        // D_R
  double shear_coefficient = unset;       // G_0: 167 sqrt(46 D_R^2 + 2.5)
  double contraction_rate = unset;        // h_po, calibrated
  double density = unset;                 // rho of the saturated soil
  double atmospheric_pressure = 101.3e3;  // p_A
  double hardening_ratio = unset;         // h_0: max(0.30, (0.25 + D_R)/2)
  double e_max = 0.8;
  double e_min = 0.5;
  double n_b = 0.5;          // exponent of the bounding surface
  double n_d = 0.1;          // of the dilatancy surface
  double A_do = unset;       // dilatancy: from M_b and M_d at the start
  double z_max = unset;      // fabric limit: min(0.7 exp(-6.1 xi_R0), 20)
  double c_z = 250.0;        // fabric growth
  double C_epsilon = unset;  // strain accumulation: 0.5 (D_R <= 0.55) to 0.2 (D_R >= 0.75)
  double phi_cv = 33.0;      // friction angle at critical state
  double poisson = 0.3;      // nu
  double C_GD = 2.0;         // G falls to 1/C_GD with fabric
  double C_DR = unset;       // dilatancy rises with D_R: min(5 + 25 (D_R - 0.35), 10)
  double C_Kaf = unset;      // static shear and fabric in K_p: 5 + 220 (D_R - 0.26)^3 in [4, 35]
  double Q = 10.0;           // Bolton's critical state line
  double R = 1.5;
  double m = 0.01;           // radius of the yield cone
  double F_sed_min = unset;  // reconsolidation: min(0.03 exp(2.6 D_R), 0.99)
  double p_sed_o = unset;    // reconsolidation: p_A/5
  Pm4Compatibility compatibility = Pm4Compatibility::improved;
  Pm4BoundingClip bounding_clip = Pm4BoundingClip::always;

  static Pm4SandParameters read(const CaseNode& node);
  double initial_void_ratio() const { return e_max - relative_density * (e_max - e_min); }
  double porosity() const { return initial_void_ratio() / (1.0 + initial_void_ratio()); }
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

// Defaults filled in. The parameters must be in their ranges (read() checks them).
Pm4SandLaw resolve(const Pm4SandParameters& parameters);

// The constants of a point that starts from the mean stress p0 and the vertical effective stress (compression
// positive): p_min always; A_do and z_max (unless they are parameters) from p0 and the input relative density when
// `recompute`.
void set_initial_constants(const Pm4SandLaw& law, double p0, double vertical_stress, bool recompute,
                           Pm4PointConstants& point);

}  // namespace tailrun::fem

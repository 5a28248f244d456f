#include "fem_stage/material/pm4silt.hpp"

#include <numbers>

#include "fem_stage/material/pm4_keys.hpp"

namespace tailrun::fem {

namespace {
double either(double given, double fallback) {
  return std::isnan(given) ? fallback : given;
}
double ratio_of(double degrees) {
  return 2.0 * std::sin(degrees * std::numbers::pi / 180.0);
}
}  // namespace

Pm4SiltParameters Pm4SiltParameters::read(const CaseNode& node) {
  Pm4SiltParameters p;
  read_optional(node, "strength", "Pa", Range::positive(), p.strength);
  read_optional(node, "strength_ratio", "1", Range::positive(), p.strength_ratio);
  if (std::isnan(p.strength) && std::isnan(p.strength_ratio)) {
    node.fail("strength_ratio", "missing; give strength (S_u,cs, Pa) or strength_ratio (S_u,cs/sigma'_v0)");
  }
  read_number(node, "strength_reduction", "1", Range::positive(), p.strength_reduction);
  p.shear_coefficient = node.number("G0", "1", Range::positive());
  // OpenSees clips PM4Silt in simple shear only.
  read_pm4_keys(node, Pm4BoundingClip::simple_shear, p);
  read_number(node, "n_G", "1", Range::between(0.0, 1.0), p.modulus_exponent);
  read_number(node, "void_ratio", "1", Range::positive(), p.void_ratio);
  read_number(node, "lambda", "1", Range::positive(), p.lambda);
  read_number(node, "n_b_wet", "1", Range::between(0.01, 1.0), p.n_b_wet);
  read_number(node, "n_b_dry", "1", Range::positive(), p.n_b_dry);
  read_optional(node, "r_u_max", "1", {0.0, 1.0, false, true}, p.r_u_max);
  read_number(node, "C_G_consolidation", "1", {1.0}, p.C_G_consolidation);
  read_number(node, "phi_b_max", "deg", {p.phi_cv, 90.0, true, false}, p.phi_b_max);
  return p;
}

Pm4SiltLaw resolve(const Pm4SiltParameters& given) {
  Pm4SiltLaw law;
  law.given = given;
  law.density = given.density;
  law.atmospheric_pressure = given.atmospheric_pressure;
  law.G0_pA = given.shear_coefficient * given.atmospheric_pressure;
  law.modulus_factor = law.G0_pA * std::pow(given.atmospheric_pressure, -given.modulus_exponent);
  law.poisson = given.poisson;
  law.bulk_over_shear = bulk_over_shear_of(given.poisson);
  law.M = ratio_of(given.phi_cv);
  law.m = given.m;
  law.h0 = given.hardening_ratio;
  law.h_po = given.contraction_rate;
  law.C_gamma1 = law.h0 / 200.0;
  law.C_Kaf = given.C_Kaf;
  law.c_z = given.c_z;
  law.C_GD = given.C_GD;
  law.C_DR = 3.0;
  law.index0 = given.void_ratio;
  law.index_slope = -(1.0 + given.void_ratio);
  law.tolerance = 1e-9 * given.atmospheric_pressure;
  law.compatibility = given.compatibility;
  law.bounding_clip = given.bounding_clip;
  law.inverse_lambda = 1.0 / given.lambda;
  law.log_F_su = std::log(given.strength_reduction);
  law.C_Mb = 1.0 / (std::pow(ratio_of(given.phi_b_max) / law.M, 1.0 / given.n_b_dry) - 1.0);
  return law;
}

void set_initial_constants(const Pm4SiltLaw& law, double p0, double vertical_stress, bool recompute,
                           Pm4PointConstants& point) {
  const Pm4SiltParameters& given = law.given;
  const double smallest = law.atmospheric_pressure / 200.0;
  if (recompute) {
    const double vertical = std::max(vertical_stress, smallest);
    const double strength = std::isnan(given.strength) ? given.strength_ratio * vertical : given.strength;
    const double ratio = strength / vertical;
    point.p_cs = 2.0 * strength / law.M;
    point.A_do = given.A_do;
    point.z_max = either(given.z_max, std::clamp(40.0 * ratio, 10.0, 20.0));
    point.C_eps_squared = square(either(given.C_epsilon, std::min(1.3, 0.5 + 1.2 * macaulay(ratio - 0.25))));
  }
  const double limit =
      std::isnan(given.r_u_max) ? std::min(p0, point.p_cs / 8.0) : (1.0 - std::min(given.r_u_max, 0.99)) * 0.5 * p0;
  point.p_min = std::max(limit, smallest);
}

}  // namespace tailrun::fem

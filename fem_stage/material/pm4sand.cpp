#include "fem_stage/material/pm4sand.hpp"

#include <numbers>

#include "fem_stage/material/pm4_keys.hpp"

namespace tailrun::fem {

namespace {
double either(double given, double fallback) {
  return std::isnan(given) ? fallback : given;
}
}  // namespace

Pm4SandParameters Pm4SandParameters::read(const CaseNode& node) {
  Pm4SandParameters p;
  p.relative_density = node.number("relative_density", "1", Range::open(0.0, 1.2));
  read_optional(node, "G0", "1", Range::positive(), p.shear_coefficient);
  read_pm4_keys(node, Pm4BoundingClip::always, p);
  read_number(node, "e_min", "1", Range::positive(), p.e_min);
  read_number(node, "e_max", "1", {p.e_min, Range::any().high, true, false}, p.e_max);
  read_number(node, "n_b", "1", Range::non_negative(), p.n_b);
  read_optional(node, "C_DR", "1", Range::positive(), p.C_DR);
  read_number(node, "Q", "1", Range::positive(), p.Q);
  read_number(node, "R", "1", Range::positive(), p.R);
  read_optional(node, "F_sed_min", "1", {0.0, 1.0, true, false}, p.F_sed_min);
  read_optional(node, "p_sed_o", "Pa", Range::positive(), p.p_sed_o);
  return p;
}

Pm4SandLaw resolve(const Pm4SandParameters& given) {
  Pm4SandLaw law;
  const double D_R = given.relative_density;
  law.given = given;
  law.density = given.density;
  law.atmospheric_pressure = given.atmospheric_pressure;
  const double G0 = either(given.shear_coefficient, 167.0 * std::sqrt(46.0 * D_R * D_R + 2.5));
  law.G0_pA = G0 * given.atmospheric_pressure;
  law.modulus_factor = law.G0_pA / std::sqrt(given.atmospheric_pressure);
  law.poisson = given.poisson;
  law.bulk_over_shear = bulk_over_shear_of(given.poisson);
  law.M = 2.0 * std::sin(given.phi_cv * std::numbers::pi / 180.0);
  law.m = given.m;
  law.h0 = either(given.hardening_ratio, std::max(0.30, 0.5 * (0.25 + D_R)));
  law.h_po = given.contraction_rate;
  law.C_gamma1 = law.h0 / 200.0;
  law.C_Kaf = either(given.C_Kaf, std::clamp(5.0 + 220.0 * cube(D_R - 0.26), 4.0, 35.0));
  law.c_z = given.c_z;
  law.C_eps_squared = square(either(given.C_epsilon, std::clamp(0.5 - 1.5 * (D_R - 0.55), 0.2, 0.5)));
  law.C_GD = given.C_GD;
  law.C_DR = either(given.C_DR, std::min(5.0 + 25.0 * (D_R - 0.35), 10.0));
  law.index0 = D_R;
  law.index_slope = (1.0 + given.initial_void_ratio()) / (given.e_max - given.e_min);
  law.tolerance = 1e-10 * given.atmospheric_pressure;
  law.compatibility = given.compatibility;
  law.bounding_clip = given.bounding_clip;
  law.n_b_dense = given.n_b;
  law.n_b_loose = 0.25 * given.n_b;
  law.n_d_dense = given.n_d;
  law.n_d_loose = 4.0 * given.n_d;
  law.Q_shifted = given.Q - std::log(100.0 / given.atmospheric_pressure);
  law.R = given.R;
  law.F_sed_min = either(given.F_sed_min, std::min(0.03 * std::exp(2.6 * D_R), 0.99));
  law.p_sed_o = either(given.p_sed_o, 0.2 * given.atmospheric_pressure);
  return law;
}

void set_initial_constants(const Pm4SandLaw& law, double p0, double /*vertical_stress*/, bool recompute,
                           Pm4PointConstants& point) {
  point.p_min = std::max(p0, law.atmospheric_pressure) / 200.0;
  point.C_eps_squared = law.C_eps_squared;
  if (!recompute) return;
  const Pm4Surfaces start = law.surfaces(point, std::max(p0, point.p_min), law.index0);
  point.z_max = either(law.given.z_max, std::min(0.7 * std::exp(-6.1 * start.xi), 20.0));
  double A_do = 1.24;
  if (start.xi < 0.0) {
    A_do =
        start.M_b > 2.0 ? 1.5 : 2.5 * (std::asin(0.5 * start.M_b) - std::asin(0.5 * law.M)) / (start.M_b - start.M_d);
  }
  point.A_do = either(law.given.A_do, A_do);
}

}  // namespace tailrun::fem

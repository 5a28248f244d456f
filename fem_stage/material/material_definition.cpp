#include "fem_stage/material/material_definition.hpp"

#include <cmath>

namespace tailrun::fem {

namespace {

Pm4Compatibility read_compatibility(const CaseNode& node) {
  const std::string word = node.choice_or("compatibility", {"improved", "opensees"}, "improved");
  return word == "opensees" ? Pm4Compatibility::opensees : Pm4Compatibility::improved;
}

Pm4BoundingClip read_bounding_clip(const CaseNode& node, Pm4BoundingClip otherwise) {
  const char* name = otherwise == Pm4BoundingClip::always ? "always" : "simple_shear";
  return node.choice_or("bounding_clip", {"always", "simple_shear"}, name) == "always" ? Pm4BoundingClip::always
                                                                                       : Pm4BoundingClip::simple_shear;
}

void optional_number(const CaseNode& node, const std::string& key, std::string_view unit, Range range, double& value) {
  if (const auto found = node.number_if(key, unit, range)) value = *found;
}

double read_shear_modulus(const CaseNode& node, double poisson) {
  if (node.has("youngs_modulus")) {
    if (node.has("shear_modulus")) {
      node.fail("youngs_modulus", "shear_modulus is given as well; give one of the two");
    }
    return node.number("youngs_modulus", "Pa", Range::positive()) / (2.0 * (1.0 + poisson));
  }
  return node.number("shear_modulus", "Pa", Range::positive());
}

// Keys that both PM4 models have.
// `opensees_clip`: what OpenSees does for this material, hence the default of the compatible mode.
template <class Parameters>
void read_pm4_common(const CaseNode& node, Pm4BoundingClip opensees_clip, Parameters& p) {
  p.contraction_rate = node.number("hpo", "1", Range::positive());
  p.density = node.number("density", "kg/m3", Range::positive());
  p.atmospheric_pressure = node.number_or("atmospheric_pressure", "Pa", Range::positive(), p.atmospheric_pressure);
  optional_number(node, "h0", "1", Range::positive(), p.hardening_ratio);
  optional_number(node, "A_do", "1", Range::positive(), p.A_do);
  optional_number(node, "z_max", "1", Range::positive(), p.z_max);
  optional_number(node, "C_epsilon", "1", Range::positive(), p.C_epsilon);
  optional_number(node, "C_Kaf", "1", Range::non_negative(), p.C_Kaf);
  p.c_z = node.number_or("c_z", "1", Range::non_negative(), p.c_z);
  p.n_d = node.number_or("n_d", "1", Range::non_negative(), p.n_d);
  p.phi_cv = node.number_or("phi_cv", "deg", Range::open(0.0, 60.0), p.phi_cv);
  p.poisson = node.number_or("poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
  p.C_GD = node.number_or("C_GD", "1", {1.0}, p.C_GD);
  p.m = node.number_or("m", "1", {0.0, 0.1, true, false}, p.m);
  p.compatibility = read_compatibility(node);
  p.bounding_clip =
      read_bounding_clip(node, p.compatibility == Pm4Compatibility::opensees ? opensees_clip : Pm4BoundingClip::always);
}

Pm4SandParameters read_pm4sand(const CaseNode& node) {
  Pm4SandParameters p;
  p.relative_density = node.number("relative_density", "1", Range::open(0.0, 1.2));
  optional_number(node, "G0", "1", Range::positive(), p.shear_coefficient);
  read_pm4_common(node, Pm4BoundingClip::always, p);
  p.e_min = node.number_or("e_min", "1", Range::positive(), p.e_min);
  p.e_max = node.number_or("e_max", "1", {p.e_min, Range::any().high, true, false}, p.e_max);
  p.n_b = node.number_or("n_b", "1", Range::non_negative(), p.n_b);
  optional_number(node, "C_DR", "1", Range::positive(), p.C_DR);
  p.Q = node.number_or("Q", "1", Range::positive(), p.Q);
  p.R = node.number_or("R", "1", Range::positive(), p.R);
  optional_number(node, "F_sed_min", "1", {0.0, 1.0, true, false}, p.F_sed_min);
  optional_number(node, "p_sed_o", "Pa", Range::positive(), p.p_sed_o);
  return p;
}

Pm4SiltParameters read_pm4silt(const CaseNode& node) {
  Pm4SiltParameters p;
  optional_number(node, "strength", "Pa", Range::positive(), p.strength);
  optional_number(node, "strength_ratio", "1", Range::positive(), p.strength_ratio);
  if (std::isnan(p.strength) && std::isnan(p.strength_ratio)) {
    node.fail("strength_ratio", "missing; give strength (S_u,cs, Pa) or strength_ratio (S_u,cs/sigma'_v0)");
  }
  p.strength_reduction = node.number_or("strength_reduction", "1", Range::positive(), p.strength_reduction);
  p.shear_coefficient = node.number("G0", "1", Range::positive());
  read_pm4_common(node, Pm4BoundingClip::simple_shear, p);
  p.modulus_exponent = node.number_or("n_G", "1", Range::between(0.0, 1.0), p.modulus_exponent);
  p.void_ratio = node.number_or("void_ratio", "1", Range::positive(), p.void_ratio);
  p.lambda = node.number_or("lambda", "1", Range::positive(), p.lambda);
  p.n_b_wet = node.number_or("n_b_wet", "1", Range::between(0.01, 1.0), p.n_b_wet);
  p.n_b_dry = node.number_or("n_b_dry", "1", Range::positive(), p.n_b_dry);
  optional_number(node, "r_u_max", "1", {0.0, 1.0, false, true}, p.r_u_max);
  p.C_G_consolidation = node.number_or("C_G_consolidation", "1", {1.0}, p.C_G_consolidation);
  p.phi_b_max = node.number_or("phi_b_max", "deg", {p.phi_cv, 90.0, true, false}, p.phi_b_max);
  return p;
}

LinearElasticParameters read_linear_elastic(const CaseNode& node) {
  LinearElasticParameters p;
  p.poisson = node.number_or("poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
  p.shear_modulus = read_shear_modulus(node, p.poisson);
  p.density = node.number("density", "kg/m3", Range::positive());
  p.porosity = node.number_or("porosity", "1", {0.0, 1.0, false, true}, p.porosity);
  return p;
}

MohrCoulombParameters read_mohr_coulomb(const CaseNode& node) {
  MohrCoulombParameters p;
  p.poisson = node.number_or("poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
  p.shear_modulus = read_shear_modulus(node, p.poisson);
  p.cohesion = node.number("cohesion", "Pa", Range::non_negative());
  p.friction_angle = node.number("friction_angle", "deg", Range::between(0.0, 60.0));
  p.dilation_angle = node.number_or("dilation_angle", "deg", Range::between(0.0, p.friction_angle), p.dilation_angle);
  p.tension_cutoff = node.number_or("tension_cutoff", "Pa", Range::non_negative(), p.tension_cutoff);
  p.density = node.number("density", "kg/m3", Range::positive());
  p.porosity = node.number_or("porosity", "1", {0.0, 1.0, false, true}, p.porosity);
  return p;
}

}  // namespace

MaterialDefinition read_material(const CaseNode& node, const std::string& name) {
  const std::string model = node.choice("model", {"linear_elastic", "mohr_coulomb", "pm4sand", "pm4silt"});
  if (model == "linear_elastic") return {name, read_linear_elastic(node)};
  if (model == "mohr_coulomb") return {name, read_mohr_coulomb(node)};
  if (model == "pm4silt") return {name, read_pm4silt(node)};
  return {name, read_pm4sand(node)};
}

double density_of(const MaterialDefinition& material) {
  return std::visit([](const auto& p) { return p.density; }, material.model);
}

double porosity_of(const MaterialDefinition& material) {
  if (const auto* p = std::get_if<Pm4SandParameters>(&material.model)) {
    const double e0 = p->e_max - p->relative_density * (p->e_max - p->e_min);
    return e0 / (1.0 + e0);
  }
  if (const auto* p = std::get_if<Pm4SiltParameters>(&material.model)) return p->void_ratio / (1.0 + p->void_ratio);
  if (const auto* p = std::get_if<MohrCoulombParameters>(&material.model)) return p->porosity;
  return std::get<LinearElasticParameters>(material.model).porosity;
}

std::string_view model_name(const MaterialDefinition& material) {
  static constexpr std::string_view names[] = {"linear_elastic", "mohr_coulomb", "pm4sand", "pm4silt"};
  return names[material.model.index()];
}

}  // namespace tailrun::fem

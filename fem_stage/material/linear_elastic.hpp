// Isotropic linear elasticity, "linear_elastic": rock, and soil where the answer is known in closed form.
#pragma once

#include "fem_stage/material/elastic_plastic_points.hpp"
#include "fem_stage/material/material_keys.hpp"

namespace tailrun::fem {

struct LinearElasticLaw {
  static constexpr bool has_yield = false;
  double shear_modulus = 0.0;  // Pa
  double poisson = 0.3;

  void set_post_shaking(bool) {}
};

struct LinearElasticParameters {
  static constexpr std::string_view model_name = "linear_elastic";
  using Points = ElasticPlasticPoints<LinearElasticLaw>;

  double shear_modulus = unset;  // G
  double poisson = 0.3;          // nu
  double density = unset;        // rho of the saturated soil
  double pore_share = 0.4;       // n

  static LinearElasticParameters read(const CaseNode& node) {
    LinearElasticParameters p;
    read_number(node, "poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
    p.shear_modulus = read_shear_modulus(node, p.poisson);
    p.density = node.number("density", "kg/m3", Range::positive());
    read_number(node, "porosity", "1", {0.0, 1.0, false, true}, p.pore_share);
    return p;
  }
  double porosity() const { return pore_share; }
};

inline LinearElasticLaw resolve(const LinearElasticParameters& given) {
  return {given.shear_modulus, given.poisson};
}

}  // namespace tailrun::fem

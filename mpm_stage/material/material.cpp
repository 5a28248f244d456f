#include "mpm_stage/material/material.hpp"

#include <cmath>
#include <numbers>

namespace tailrun::mpm {

MaterialConstants constants_of(const Material& material, double cell_size) {
  constexpr double degree = std::numbers::pi / 180.0;
  MaterialConstants k;
  k.model = material.model;
  if (material.model == Model::newtonian_fluid) {
    k.bulk = material.bulk_modulus;
  } else {
    const double E = material.youngs_modulus, nu = material.poisson_ratio;
    k.mu = E / (2.0 * (1.0 + nu));
    k.lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    k.bulk = k.lambda + 2.0 / 3.0 * k.mu;
  }
  k.sin_phi = std::sin(material.friction_angle * degree);
  k.m = (1.0 + std::sin(material.dilation_angle * degree)) / (1.0 - std::sin(material.dilation_angle * degree));
  k.tension = material.tension_cutoff;
  k.reference_density = material.density;
  const Softening& s = material.softening;
  k.softens = s.active;
  k.exponential = s.shape == SofteningShape::exponential;
  const double scale = s.reference_length > 0.0 ? s.reference_length / cell_size : 1.0;
  k.soften_start = s.start_strain * scale;
  k.soften_scale = (k.exponential ? s.end_strain : s.end_strain - s.start_strain) * scale;
  k.cohesion_ratio = s.active ? s.cohesion_ratio : 1.0;
  k.sin_phi_residual = s.active && s.residual_friction >= 0.0 ? std::sin(s.residual_friction * degree) : k.sin_phi;
  k.consistency = material.rate.consistency;
  k.exponent = material.rate.exponent;
  k.allow_tension = material.allow_tension;
  k.averaged = material.average_volumetric_strain;
  k.pore_pressure = material.pore_pressure;
  k.pore_stiffness = material.pore_stiffness;
  return k;
}

std::string model_name(Model model) {
  switch (model) {
    case Model::linear_elastic:
      return "linear_elastic";
    case Model::mohr_coulomb:
      return "mohr_coulomb";
    case Model::tresca:
      return "tresca";
    case Model::newtonian_fluid:
      return "newtonian_fluid";
    case Model::rigid:
      return "rigid";
  }
  return "";
}

}  // namespace tailrun::mpm

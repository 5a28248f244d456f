#include "mpm_stage/material/elastic_solid.hpp"

namespace tailrun::mpm {

void read_elastic_solid(const CaseNode& node, const char* pore_pressure, Material& m) {
  // Of particles made here, solid and pore water together.
  m.density = node.number_or("density", "kg/m3", Range::positive(), 2000.0);
  // E and nu, of the skeleton; of the whole where stresses are total.
  m.youngs_modulus = node.number("youngs_modulus", "Pa", Range::positive());
  m.poisson_ratio = node.number("poisson_ratio", "1", {-0.9, 0.4999, false, false});
  // total: added to the stress, which goes on as total stress; frozen: as handed over (frozen_pore_pressure.hpp);
  // undrained: follows the volume.
  const std::string pore = node.choice_or("pore_pressure", {"total", "frozen", "undrained"}, pore_pressure);
  m.pore_pressure = pore == "total"    ? PorePressure::total
                    : pore == "frozen" ? PorePressure::frozen
                                       : PorePressure::undrained;
  // K_f / n, of the pore water.
  if (m.pore_pressure == PorePressure::undrained)
    m.pore_stiffness = node.number("pore_stiffness", "Pa", Range::positive());
}

void set_elastic_constants(const Material& m, MaterialConstants& k) {
  const double E = m.youngs_modulus, nu = m.poisson_ratio;
  k.mu = E / (2.0 * (1.0 + nu));
  k.lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  k.bulk = k.lambda + 2.0 / 3.0 * k.mu;
}

}  // namespace tailrun::mpm

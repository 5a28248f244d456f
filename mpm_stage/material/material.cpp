#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

MaterialConstants constants_of(const Material& material, double cell_size) {
  MaterialConstants k;
  k.reference_density = material.density;
  k.flows = material.law->flows;
  k.averaged = material.average_volumetric_strain;
  k.pore_pressure = material.pore_pressure;
  k.pore_stiffness = material.pore_stiffness;
  material.law->set_constants(material, cell_size, k);
  return k;
}

}  // namespace tailrun::mpm

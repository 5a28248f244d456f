#include "fem_stage/material/material_keys.hpp"

namespace tailrun::fem {

void read_number(const CaseNode& node, const std::string& key, std::string_view unit, Range range, double& value) {
  value = node.number_or(key, unit, range, value);
}

void read_optional(const CaseNode& node, const std::string& key, std::string_view unit, Range range, double& value) {
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

}  // namespace tailrun::fem

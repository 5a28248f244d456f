// The laws that a material can follow.
#pragma once

#include <string>
#include <vector>

#include "mpm_stage/material/material_law.hpp"

namespace tailrun::mpm {

const std::vector<const MaterialLaw*>& material_laws();
std::vector<std::string> law_names();  // in the order of the list

}  // namespace tailrun::mpm

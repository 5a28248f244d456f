// A named material of a case: the parameters of one of the models, read from the case file and checked.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "common/case_file.hpp"
#include "fem_stage/material/linear_elastic.hpp"
#include "fem_stage/material/mohr_coulomb.hpp"
#include "fem_stage/material/pm4sand.hpp"
#include "fem_stage/material/pm4silt.hpp"

namespace tailrun::fem {

struct MaterialDefinition {
  std::string name;
  std::variant<LinearElasticParameters, MohrCoulombParameters, Pm4SandParameters, Pm4SiltParameters> model;
};

// Reads {"model": "linear_elastic" | "mohr_coulomb" | "pm4sand" | "pm4silt", ...}. Keys and defaults are those of the
// parameter structs' tables (docs/formats.md lists them); stiffness of the first two is "shear_modulus" or
// "youngs_modulus". Throws InputError for unknown models and values out of range.
MaterialDefinition read_material(const CaseNode& node, const std::string& name = "");

// Saturated bulk density, kg/m3, and porosity n = e0/(1 + e0).
double density_of(const MaterialDefinition& material);
double porosity_of(const MaterialDefinition& material);

std::string_view model_name(const MaterialDefinition& material);

}  // namespace tailrun::fem

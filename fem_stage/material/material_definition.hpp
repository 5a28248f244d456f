// A named material of a case: the parameters of one of the models, read from the case file and checked.
#pragma once

#include <string>
#include <string_view>

#include "fem_stage/material/models.hpp"

namespace tailrun::fem {

struct MaterialDefinition {
  std::string name;
  Models::AnyParameters model;
};

// Reads {"model": <one of the list>, ...} with the model's own keys (docs/fem.md lists them). Throws InputError for
// unknown models and values out of range.
MaterialDefinition read_material(const CaseNode& node, const std::string& name = "");

// Saturated bulk density, kg/m3, and porosity n = e0/(1 + e0).
double density_of(const MaterialDefinition& material);
double porosity_of(const MaterialDefinition& material);

std::string_view model_name(const MaterialDefinition& material);

}  // namespace tailrun::fem

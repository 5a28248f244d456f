// Reading the numbers of a material. The initial value of a parameter is its default, so that default and meaning stand
// with the parameter, unit and range with its key, and no number is written twice.
#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "common/case_file.hpp"

namespace tailrun::fem {

// A parameter that has no default: it is required, or the model works it out from the others.
inline constexpr double unset = std::numeric_limits<double>::quiet_NaN();

// Both leave `value` as it is where the key is missing. The first lists it among the run's options as a default, the
// second does not: for numbers that follow from others in one model or the other.
void read_number(const CaseNode& node, const std::string& key, std::string_view unit, Range range, double& value);
void read_optional(const CaseNode& node, const std::string& key, std::string_view unit, Range range, double& value);

// Shear modulus, Pa, from "shear_modulus" or from "youngs_modulus" and Poisson's ratio; one of the two is required.
double read_shear_modulus(const CaseNode& node, double poisson);

}  // namespace tailrun::fem

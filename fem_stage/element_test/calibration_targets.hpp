// What a soil is to be calibrated to, and how near a set of PM4Sand's parameters comes to it.
#pragma once

#include <optional>
#include <vector>

#include "common/case_file.hpp"
#include "fem_stage/material/pm4sand.hpp"

namespace tailrun::fem {

struct CyclicTarget {
  double csr = 0.0;
  double cycles = 15.0;
  double shear_strain = 0.03;
  double vertical_effective_stress = 1e5;  // Pa
  double K0 = 0.5;
  double static_shear_ratio = 0.0;
};

struct StrengthTarget {
  double vertical_effective_stress = 0.0;  // Pa
  double shear_stress = 0.0;               // Pa
};

struct Targets {
  std::optional<CyclicTarget> cyclic;
  double working_strain = 0.1;
  double residual_K0 = 0.5;
  std::vector<StrengthTarget> residual;
};

// Throws InputError.
Targets read_targets(const CaseNode& root);

// Cycles until the criterion strain; `most_cycles` when it is not reached by then.
double cycles_to_failure(const Pm4SandParameters& sand, const CyclicTarget& target, double csr, double most_cycles);

// Shear stress (Pa) at the working strain in undrained monotonic simple shear.
double working_strength(const Pm4SandParameters& sand, const Targets& targets, double vertical_effective_stress);

// Mean logarithm of strength over target.
double mean_log_strength_ratio(const Pm4SandParameters& sand, const Targets& targets);

}  // namespace tailrun::fem

// A rule's "residual_strength" object: one of the correlations, a table or bins, with percentile, factor and bounds.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/case_file.hpp"

namespace tailrun::transfer {

// What one evaluation gave.
struct Strength {
  double value = 0.0;       // Pa, after factor and bounds
  bool is_capped = false;   // by sigma'_v0 tan(phi')
  bool is_raised = false;   // by the lower bound
  bool is_outside = false;  // of the correlation's case histories
  std::optional<long> bin;  // of the model "bins", from 0
};

// s_R = bounds(factor x model(sigma'_v0)):
//   cap    sigma'_v0 tan(friction_angle), the drained strength (Idriss & Boulanger 2008); off with drained_cap false
//   lower  max(minimum_ratio x sigma'_v0, minimum_strength), so that the particle stage never sees zero or less
// The lower bound wins where the two cross, at stresses next to nothing.
struct StrengthLaw {
  std::string model;
  std::function<double(double)> evaluate_model;     // sigma'_v0 (Pa) to s_R (Pa)
  std::vector<double> bin_edges, bin_strengths;     // Pa; the model "bins"
  std::pair<double, double> domain = {0.0, 1e300};  // sigma'_v0 (Pa) of the case histories or of the table
  std::vector<std::string> warnings;                // inputs outside of the correlation's case histories
  nlohmann::ordered_json record;                    // model and inputs, for the output file
  double factor = 1.0;
  bool drained_cap = true;
  double friction_angle = 34.0;     // degrees
  double minimum_ratio = 0.02;      // 1
  double minimum_strength = 200.0;  // Pa

  Strength operator()(double sigma_v0) const;
};

// Reads {"model": ..., inputs of that model, "percentile", "factor", "drained_cap", "friction_angle", "minimum_ratio",
// "minimum_strength"}. Throws InputError.
StrengthLaw read_strength_law(const CaseNode& node);

}  // namespace tailrun::transfer

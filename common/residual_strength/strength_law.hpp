// A law for the residual strength of liquefied soil: one of the correlations, a table or bins, with percentile, factor
// and bounds. Chosen at the hand-over ("residual_strength" of a rule in transfer.json), and again at the runout
// ("residual_strength" of mpm.json) for particles that carry sigma'_v0 and the law that they were given.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/case_file.hpp"

namespace tailrun {

// What one evaluation gave.
struct Strength {
  double value = 0.0;       // Pa, after factor and bounds
  bool is_capped = false;   // by sigma'_v0 tan(phi')
  bool is_raised = false;   // by the lower bound
  bool is_outside = false;  // of the correlation's case histories
};

// s_R = bounds(factor x model(sigma'_v0)):
//   cap    sigma'_v0 tan(friction_angle), the drained strength (Idriss & Boulanger 2008); off with drained_cap false
//   lower  max(minimum_ratio x sigma'_v0, minimum_strength), so that the particle stage never sees zero or less
// The lower bound wins where the two cross, at stresses next to nothing.
struct StrengthLaw {
  std::string model;
  std::function<double(double)> evaluate_model;     // sigma'_v0 (Pa) to s_R (Pa)
  std::pair<double, double> domain = {0.0, 1e300};  // sigma'_v0 (Pa) of the case histories or of the table
  std::vector<std::string> warnings;                // inputs outside of the correlation's case histories
  nlohmann::ordered_json record;                    // every key with its value: read back, it is the same law
  double factor = 1.0;
  bool drained_cap = true;
  double friction_angle = 34.0;     // degrees
  double minimum_ratio = 0.02;      // 1
  double minimum_strength = 200.0;  // Pa

  // `sigma_v0` Pa; below zero counts as zero.
  Strength operator()(double sigma_v0) const;
};

// A law that was chosen before, for one that changes it: `record` as above. `place` says for messages where it stands
// ("particles.h5: /tailrun/strength_laws, row 0"); with an empty record it says why there is none.
struct KeptStrengthLaw {
  nlohmann::ordered_json record;
  std::string place;
};

// The names of the models, in the order in which documents list them.
const std::vector<std::string>& strength_models();
// Every key that read_changed_strength_law may ask for.
const std::vector<std::string>& strength_law_keys();
// Whether the model knows a percentile.
bool has_percentile(const std::string& model);

// Reads {"model": ..., inputs of that model, "percentile", "factor", "drained_cap", "friction_angle", "minimum_ratio",
// "minimum_strength"}. "blow_count", "cone_resistance" and "fines_content" may stand beside any model: one that has no
// use for them keeps them for another choice later. Throws InputError.
StrengthLaw read_strength_law(const CaseNode& node);

// The same keys but "factor" (whoever reads them again has a factor of its own, on top), all optional: what is not
// given is the kept law's. Of another model the kept law gives what does not depend on the model: percentile, bounds,
// blow_count and fines_content (with a warning where models mean different counts by it), cone_resistance if both mean
// the same; not its factor. A law of the same model with nothing given is the same to the last bit. A `model` that is
// not empty takes the place of "model". Throws InputError.
StrengthLaw read_changed_strength_law(const CaseNode& node, const KeptStrengthLaw& kept, const std::string& model = {});

}  // namespace tailrun

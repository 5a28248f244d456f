// The relations for the residual strength over sigma'_v0, side by side: the law that each rule of transfer.json has
// chosen, and what the other models make of the same soil data, with percentiles. For choosing, before anything runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "common/residual_strength/strength_law.hpp"

namespace tailrun::transfer {

struct StrengthCurve {
  std::size_t rule = 0;  // index in /rules
  std::string material;
  std::string relation;              // model, with its variant: "idriss_boulanger, negligible redistribution"
  std::optional<double> percentile;  // %
  bool chosen = false;               // the rule's own law
  StrengthLaw law;
};

// The curves of every rule with a strength: first its own law, then each model whose inputs the rule's law has (or that
// needs none), at `percentiles` (%, each in (0, 100)) where it knows them, within the rule's own bounds and without its
// factor. Reads and checks "residual_strength" of every rule, and nothing else of the file. Throws InputError; one that
// no rule has a strength is among them.
std::vector<StrengthCurve> strength_curves(const CaseFile& file, const std::vector<double>& percentiles);

// kPa at some sigma'_v0 up to `highest` (Pa), a block for each rule and a line for each curve; what a bound has made is
// marked.
std::string strength_text(const std::vector<StrengthCurve>& curves, double highest);

// One row for each curve and sigma'_v0, `points` of them from 0 to `highest` (Pa): rule, material, relation, percentile
// (empty: none), chosen, sigma_v0_Pa, s_R_Pa, capped, raised, outside_of_domain.
std::string strength_csv(const std::vector<StrengthCurve>& curves, double highest, std::size_t points);

}  // namespace tailrun::transfer

// What a strength law made of the points or particles that it was given: for records, summaries and warnings.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tailrun {

struct Strength;
struct StrengthLaw;

// Least, mean and largest of some numbers.
struct Spread {
  double least = 1e300, most = -1e300, sum = 0.0;
  void add(double value);
  // {"smallest": ..., "mean": ..., "largest": ...}; null for a count of 0.
  nlohmann::ordered_json json(long count) const;
};

struct StrengthTally {
  long count = 0, capped = 0, raised = 0, outside = 0;
  Spread strength, stress;  // Pa: s_R and sigma'_v0

  void add(double sigma_v0, const Strength& found);
  // Sentences about the law's inputs, strengths that were raised, and stresses beyond its case histories.
  std::vector<std::string> warnings(const StrengthLaw& law) const;
};

}  // namespace tailrun

#include "common/residual_strength/strength_tally.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "common/residual_strength/strength_law.hpp"

namespace tailrun {

void Spread::add(double value) {
  least = std::min(least, value);
  most = std::max(most, value);
  sum += value;
}

nlohmann::ordered_json Spread::json(long count) const {
  if (count == 0) return nullptr;
  return {{"smallest", least}, {"mean", sum / static_cast<double>(count)}, {"largest", most}};
}

void StrengthTally::add(double sigma_v0, const Strength& found) {
  ++count;
  capped += found.is_capped;
  raised += found.is_raised;
  outside += found.is_outside;
  strength.add(found.value);
  stress.add(sigma_v0);
}

std::vector<std::string> StrengthTally::warnings(const StrengthLaw& law) const {
  std::vector<std::string> said = law.warnings;
  if (2 * raised > count)
    said.push_back(
        fmt::format("{} of {} points have so little strength that it was raised to the lower bound; are "
                    "strengths and stresses in Pa?",
                    raised, count));
  if (outside > 0)
    said.push_back(fmt::format("{} of {} points have sigma'_v0 outside of {:g} to {:g} kPa", outside, count,
                               law.domain.first / 1e3, law.domain.second / 1e3));
  return said;
}

}  // namespace tailrun

#include "transfer_tool/assign/strength_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/plausible_material.hpp"
#include "transfer_tool/assign/residual_strength.hpp"

namespace tailrun::transfer {
namespace {

constexpr double stress_of_case_histories = 400e3;  // Pa; beyond it every correlation extrapolates
constexpr double blows_of_case_histories = 15.0;

// Reads a number and keeps it for the record.
class Inputs {
 public:
  Inputs(const CaseNode& node, StrengthLaw& law) : node_(node), law_(law) {}

  double number(const std::string& key, std::string_view unit, Range range) {
    const double value = node_.number(key, unit, range);
    law_.record[key] = value;
    return value;
  }
  double number_or(const std::string& key, std::string_view unit, Range range, double fallback) {
    const double value = node_.number_or(key, unit, range, fallback);
    law_.record[key] = value;
    return value;
  }
  bool boolean_or(const std::string& key, bool fallback) {
    const bool value = node_.boolean_or(key, fallback);
    law_.record[key] = value;
    return value;
  }
  std::vector<double> numbers(const std::string& key, Range range) {
    auto values = node_.numbers(key, "Pa", range);
    law_.record[key] = values;
    // Stresses in kPa: the largest of a list tells, for the smallest may be 0.
    if (!values.empty() && *std::max_element(values.begin(), values.end()) < 1e3 && key != "strength" &&
        key != "strengths")
      node_.warn(key, fmt::format("the largest is {:g} Pa, the stress under less than a tenth of a metre of soil; are "
                                  "they in kPa?",
                                  *std::max_element(values.begin(), values.end())));
    else if (!values.empty())
      check_residual_strength(node_, key, *std::max_element(values.begin(), values.end()));
    return values;
  }
  // Standard normal quantile of "percentile" (50: the median).
  double percentile() {
    return standard_normal_quantile(number_or("percentile", "%", Range::open(0.0, 100.0), 50.0) / 100.0);
  }
  double blows(const std::string& key, double highest) {
    const double value = number(key, "1", Range::between(0.0, 60.0));
    if (value > highest)
      law_.warnings.push_back(fmt::format("{} = {:g} lies above the case histories' {:g}", key, value, highest));
    return value;
  }
  const CaseNode& node() const { return node_; }

 private:
  const CaseNode& node_;
  StrengthLaw& law_;
};

void read_table(Inputs& in, StrengthLaw& law) {
  const auto stress = in.numbers("initial_vertical_effective_stress", Range::non_negative());
  const auto strength = in.numbers("strength", Range::positive());
  if (stress.size() < 2 || stress.size() != strength.size())
    in.node().fail("strength",
                   fmt::format("found {} strengths for {} stresses; equal numbers, at least 2, are required",
                               strength.size(), stress.size()));
  if (std::adjacent_find(stress.begin(), stress.end(), std::greater_equal<>()) != stress.end())
    in.node().fail("initial_vertical_effective_stress", "the stresses must increase");
  law.domain = {stress.front(), stress.back()};
  law.evaluate_model = [stress, strength](double sigma) {
    if (sigma <= stress.front()) return strength.front();
    if (sigma >= stress.back()) return strength.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(stress.begin(), stress.end(), sigma) - stress.begin());
    return strength[i - 1] + (strength[i] - strength[i - 1]) * (sigma - stress[i - 1]) / (stress[i] - stress[i - 1]);
  };
}

void read_bins(Inputs& in, StrengthLaw& law) {
  const auto edges = in.numbers("edges", Range::positive());
  const auto strengths = in.numbers("strengths", Range::positive());
  if (strengths.size() != edges.size() + 1)
    in.node().fail("edges", fmt::format("found {} edges for {} strengths; {} inner edges are required", edges.size(),
                                        strengths.size(), strengths.size() - 1));
  if (std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) != edges.end())
    in.node().fail("edges", "the edges must increase");
  law.bin_edges = edges;
  law.bin_strengths = strengths;
}

void read_idriss_boulanger(Inputs& in, StrengthLaw& law) {
  const bool redistribution = in.boolean_or("void_redistribution", true);
  const double fines = in.number_or("fines_content", "%", Range::between(0.0, 100.0), 0.0);
  double ratio = 0.0;
  if (in.node().has("cone_resistance")) {
    const double q = in.number("cone_resistance", "1", Range::between(0.0, 200.0)) + fines_increment_cpt(fines);
    if (q > 90.0) law.warnings.push_back(fmt::format("q_c1Ncs-Sr = {:g} lies above the case histories' 90", q));
    ratio = idriss_boulanger_cpt_ratio(q, redistribution);
  } else {
    const double n = in.number("blow_count", "1", Range::between(0.0, 60.0)) + fines_increment_spt(fines);
    if (n > 14.0) law.warnings.push_back(fmt::format("N60cs-Sr = {:g} lies above the case histories' 14", n));
    ratio = idriss_boulanger_spt_ratio(n, redistribution);
  }
  law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
}

void read_olson_stark(Inputs& in, StrengthLaw& law) {
  const double z = in.percentile();
  double ratio = 0.0;
  if (in.node().has("cone_resistance")) {
    const double q = in.number("cone_resistance", "Pa", Range::between(0.0, 50e6));
    if (q > 6.5e6) law.warnings.push_back(fmt::format("q_c1 = {:g} MPa lies above the correlation's 6.5", q / 1e6));
    ratio = olson_stark_cpt_ratio(q, z);
  } else {
    ratio = olson_stark_spt_ratio(in.blows("blow_count", 12.0), z);
  }
  law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
}

void read_robertson(Inputs& in, StrengthLaw& law, bool is_2010) {
  const double q = in.number("cone_resistance", "1", Range::between(0.0, is_2010 ? 70.0 : 80.0));
  const double ratio = is_2010 ? robertson_2010_ratio(q) : robertson_2022_ratio(q);
  law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
}

}  // namespace

StrengthLaw read_strength_law(const CaseNode& node) {
  StrengthLaw law;
  law.model = node.choice("model", {"table", "bins", "seed_fit", "weber", "kramer_wang", "idriss_boulanger",
                                    "olson_stark", "robertson_2010", "robertson_2022", "ratio", "constant"});
  law.record["model"] = law.model;
  law.domain = {0.0, stress_of_case_histories};
  Inputs in(node, law);
  if (law.model == "table") {
    read_table(in, law);
  } else if (law.model == "bins") {
    read_bins(in, law);
  } else if (law.model == "seed_fit") {
    const double n = in.number_or("blow_count", "1", Range::between(0.0, 60.0), 6.0);
    if (n != 6.0) law.warnings.push_back(fmt::format("seed_fit was fitted for N60cs = 6, used with {:g}", n));
    law.evaluate_model = [n](double sigma) { return seed_fit(n, sigma); };
  } else if (law.model == "weber") {
    const double n = in.blows("blow_count", blows_of_case_histories), z = in.percentile();
    law.evaluate_model = [n, z](double sigma) { return weber_2015(n, sigma, z); };
  } else if (law.model == "kramer_wang") {
    const double n = in.blows("blow_count", blows_of_case_histories), z = in.percentile();
    law.evaluate_model = [n, z](double sigma) { return kramer_wang_2015(n, sigma, z); };
  } else if (law.model == "idriss_boulanger") {
    read_idriss_boulanger(in, law);
  } else if (law.model == "olson_stark") {
    read_olson_stark(in, law);
  } else if (law.model == "robertson_2010" || law.model == "robertson_2022") {
    read_robertson(in, law, law.model == "robertson_2010");
  } else if (law.model == "ratio") {
    const double ratio = in.number("ratio", "1", Range::positive());
    law.domain.second = 1e300;
    law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
  } else {
    const double strength = in.number("strength", "Pa", Range::positive());
    check_residual_strength(node, "strength", strength);
    law.domain.second = 1e300;
    law.evaluate_model = [strength](double) { return strength; };
  }
  law.factor = in.number_or("factor", "1", Range::positive(), law.factor);
  check_factor(node, "factor", law.factor);
  law.drained_cap = in.boolean_or("drained_cap", law.drained_cap);
  law.friction_angle = in.number_or("friction_angle", "deg", Range::open(0.0, 60.0), law.friction_angle);
  check_angle(node, "friction_angle", law.friction_angle);
  law.minimum_ratio = in.number_or("minimum_ratio", "1", Range::non_negative(), law.minimum_ratio);
  law.minimum_strength = in.number_or("minimum_strength", "Pa", Range::positive(), law.minimum_strength);
  return law;
}

Strength StrengthLaw::operator()(double sigma_v0) const {
  const double sigma = std::max(sigma_v0, 0.0);
  Strength result;
  result.is_outside = sigma < domain.first || sigma > domain.second;
  if (!bin_strengths.empty()) {
    result.bin = std::upper_bound(bin_edges.begin(), bin_edges.end(), sigma) - bin_edges.begin();
    result.value = factor * bin_strengths[static_cast<std::size_t>(*result.bin)];
  } else {
    result.value = factor * evaluate_model(sigma);
  }
  const double cap = sigma * std::tan(friction_angle * std::numbers::pi / 180.0);
  if (drained_cap && result.value > cap) {
    result.value = cap;
    result.is_capped = true;
  }
  const double lowest = std::max(minimum_ratio * sigma, minimum_strength);
  if (result.value < lowest) {
    result.value = lowest;
    result.is_raised = true;
  }
  return result;
}

}  // namespace tailrun::transfer

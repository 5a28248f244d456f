#include "transfer_tool/assign/strength_table.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "common/error.hpp"
#include "common/json_text.hpp"

namespace tailrun::transfer {
namespace {

using Json = nlohmann::ordered_json;

// Inputs without which a model means nothing for a soil; any one of them does.
const std::vector<std::pair<std::string, std::vector<std::string>>>& comparable_models() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> models = {
      {"seed_fit", {"blow_count"}},
      {"weber", {"blow_count"}},
      {"kramer_wang", {"blow_count"}},
      {"idriss_boulanger", {"blow_count", "cone_resistance"}},
      {"olson_stark", {"blow_count", "cone_resistance"}},
      {"robertson_2010", {"cone_resistance"}},
      {"robertson_2022", {"cone_resistance"}}};
  return models;
}

// What `model` makes of the soil of `chosen`; nothing where the soil's data are of another kind or out of its range.
std::optional<StrengthLaw> other_law(const CaseFile& file, const StrengthLaw& chosen, const std::string& model,
                                     std::optional<double> percentile, std::optional<bool> redistribution) {
  KeptStrengthLaw kept{chosen.record, "the rule's law"};
  kept.record.erase("factor");
  if (percentile) kept.record["percentile"] = *percentile;
  if (redistribution) kept.record["void_redistribution"] = *redistribution;
  try {
    // Nothing in the case file changes it.
    return read_changed_strength_law(file.root().object_or_empty("no such key"), kept, model);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void add_curves_of_rule(const CaseFile& file, const std::vector<double>& percentiles, StrengthCurve chosen,
                        std::vector<StrengthCurve>& curves) {
  const Json& data = chosen.law.record;
  for (const auto& candidate : comparable_models()) {
    const std::string& model = candidate.first;
    const std::vector<std::string>& inputs = candidate.second;
    const bool known = std::any_of(inputs.begin(), inputs.end(), [&](const auto& key) { return data.contains(key); });
    if (!known) continue;
    const auto add = [&](const std::string& relation, std::optional<double> percentile,
                         std::optional<bool> redistribution) {
      if (auto law = other_law(file, chosen.law, model, percentile, redistribution))
        curves.push_back({chosen.rule, chosen.material, relation, percentile, false, std::move(*law)});
    };
    if (model == "idriss_boulanger") {
      add(model + ", void redistribution", std::nullopt, true);
      add(model + ", negligible redistribution", std::nullopt, false);
    } else if (has_percentile(model)) {
      for (const double percentile : percentiles) add(model, percentile, std::nullopt);
    } else {
      add(model, std::nullopt, std::nullopt);
    }
  }
}

std::string words_of(const StrengthCurve& curve) {
  return (curve.chosen ? "* " : "  ") + curve.relation +
         (curve.percentile ? fmt::format(", {:g} %", *curve.percentile) : "");
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

// The law with its inputs: "weber, blow_count 6, percentile 33, ...".
std::string inputs_of(const Json& record) {
  std::string text;
  for (const auto& [key, value] : record.items())
    text += key == "model" ? value.get<std::string>() : fmt::format(", {} {}", key, text_of_json(value));
  return text;
}

}  // namespace

std::vector<StrengthCurve> strength_curves(const CaseFile& file, const std::vector<double>& percentiles) {
  const CaseNode root = file.root();
  for (const auto& key : root.keys()) root.has(key);  // the rest of the file is `run`'s business
  std::vector<StrengthCurve> chosen;
  const auto rules = root.list("rules");
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const std::string material = rules[r].text("material");
    rules[r].has("when");
    if (const auto node = rules[r].object_if("residual_strength")) {
      StrengthLaw law = read_strength_law(*node);
      std::optional<double> percentile;
      if (has_percentile(law.model)) percentile = law.record["percentile"].get<double>();
      chosen.push_back({r, material, law.model, percentile, true, std::move(law)});
    }
  }
  file.finish();
  if (chosen.empty()) root.fail("rules", "no rule has a residual_strength");
  std::vector<StrengthCurve> curves;
  for (const auto& curve : chosen) {
    curves.push_back(curve);
    add_curves_of_rule(file, percentiles, curve, curves);
  }
  return curves;
}

std::string strength_text(const std::vector<StrengthCurve>& curves, double highest) {
  std::vector<double> stresses;
  for (const double sigma : {10e3, 20e3, 50e3, 100e3, 150e3, 200e3, 300e3, 400e3, 600e3, 800e3, 1000e3})
    if (sigma <= highest) stresses.push_back(sigma);
  if (stresses.empty() || stresses.back() < highest) stresses.push_back(highest);
  std::size_t width = 0;
  for (const auto& curve : curves) width = std::max(width, words_of(curve).size());
  std::string text;
  bool capped = false, raised = false, outside = false;
  for (const auto& curve : curves) {
    if (curve.chosen) {
      text += fmt::format("{}rule {}, {}: s_R in kPa over sigma'_v0; * the case's own\n  {}\n\n{:{}}",
                          text.empty() ? "" : "\n", curve.rule, curve.material, inputs_of(curve.law.record), "", width);
      for (const double sigma : stresses) text += fmt::format("{:>8.4g} ", sigma / 1e3);
      text += "kPa\n";
    }
    text += fmt::format("{:{}}", words_of(curve), width);
    for (const double sigma : stresses) {
      const Strength s = curve.law(sigma);
      text += fmt::format("{:>8.2f}{}", s.value / 1e3,
                          s.is_capped    ? 'c'
                          : s.is_raised  ? 'r'
                          : s.is_outside ? 'o'
                                         : ' ');
      capped = capped || s.is_capped;
      raised = raised || (s.is_raised && !s.is_capped);
      outside = outside || (s.is_outside && !s.is_capped && !s.is_raised);
    }
    text += "\n";
  }
  if (capped) text += "c  the drained strength\n";
  if (raised) text += "r  raised to the lower bound\n";
  if (outside) text += "o  outside of the case histories\n";
  for (const auto& curve : curves)
    for (const auto& warning : curve.law.warnings)
      if (const auto line = fmt::format("{}: {}\n", curve.law.model, warning); text.find(line) == std::string::npos)
        text += line;
  return text;
}

std::string strength_csv(const std::vector<StrengthCurve>& curves, double highest, std::size_t points) {
  std::string text = "rule,material,relation,percentile,chosen,sigma_v0_Pa,s_R_Pa,capped,raised,outside_of_domain\n";
  for (const auto& curve : curves)
    for (std::size_t i = 0; i < points; ++i) {
      const double sigma = highest * static_cast<double>(i) / static_cast<double>(points - 1);
      const Strength s = curve.law(sigma);
      text += fmt::format("{},{},{},{},{:d},{:.9g},{:.9g},{:d},{:d},{:d}\n", curve.rule, quoted(curve.material),
                          quoted(curve.relation), curve.percentile ? fmt::format("{:g}", *curve.percentile) : "",
                          curve.chosen, sigma, s.value, s.is_capped, s.is_raised, s.is_outside);
    }
  return text;
}

}  // namespace tailrun::transfer

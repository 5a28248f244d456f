// "residual_strength" of a case file, read into a law.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "common/error.hpp"
#include "common/plausible_angles.hpp"
#include "common/plausible_material.hpp"
#include "common/residual_strength/relations.hpp"
#include "common/residual_strength/strength_law.hpp"

namespace tailrun {
namespace {

using Json = nlohmann::ordered_json;

constexpr double stress_of_case_histories = 400e3;  // Pa; beyond it every correlation extrapolates
constexpr double blows_of_case_histories = 15.0;

// What a model means by the two measurements; empty: it has no use for one. Models that take both share a word only if
// one number serves both.
struct Measurements {
  const char* blow_count;
  const char* cone_resistance;
};

Measurements meanings_of(const std::string& model) {
  if (model == "weber" || model == "seed_fit") return {"(N1)60cs", ""};
  if (model == "kramer_wang") return {"(N1)60", ""};
  if (model == "olson_stark") return {"(N1)60", "q_c1 in Pa"};
  if (model == "idriss_boulanger") return {"(N1)60", "q_c1N"};
  if (model == "robertson_2010" || model == "robertson_2022") return {"", "Q_tn,cs"};
  return {"", ""};
}

// Reads a value and keeps it for the record; what the case file lacks may come from a law chosen before.
class Inputs {
 public:
  Inputs(const CaseNode& node, StrengthLaw& law, const KeptStrengthLaw* kept) : node_(node), law_(law), kept_(kept) {
    if (kept_ && kept_->record.contains("model") && kept_->record["model"].is_string())
      kept_model_ = kept_->record["model"].get<std::string>();
  }

  const std::string& kept_model() const { return kept_model_; }

  double number(const std::string& key, std::string_view unit, Range range) {
    const auto before = kept_number(key, range);
    if (!before) say_missing(key);
    return keep(key, before ? node_.number_or(key, unit, range, *before) : node_.number(key, unit, range));
  }
  double number_or(const std::string& key, std::string_view unit, Range range, double fallback) {
    return keep(key, node_.number_or(key, unit, range, kept_number(key, range).value_or(fallback)));
  }
  bool boolean_or(const std::string& key, bool fallback) {
    if (const Json* before = kept_value(key)) {
      if (!before->is_boolean()) refuse_kept(key, "true or false is required");
      fallback = before->get<bool>();
    }
    return keep(key, node_.boolean_or(key, fallback));
  }
  std::vector<double> numbers(const std::string& key, Range range) {
    const auto before = kept_numbers(key, range);
    if (!before) say_missing(key);
    auto values = keep(key, before ? node_.numbers_or(key, "Pa", range, *before) : node_.numbers(key, "Pa", range));
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
    check_percentile(node_, "percentile");
    return standard_normal_quantile(number_or("percentile", "%", Range::open(0.0, 100.0), 50.0) / 100.0);
  }
  double blows(double highest) {
    const double value = number("blow_count", "1", Range::between(0.0, 60.0));
    if (value > highest)
      law_.warnings.push_back(fmt::format("blow_count = {:g} lies above the case histories' {:g}", value, highest));
    return value;
  }
  // Whether the soil is known by its cone resistance rather than by its blow count.
  bool has_cone() const {
    if (node_.has("cone_resistance")) {
      if (node_.has("blow_count"))
        node_.warn("blow_count", fmt::format("is not used: '{}' takes one of the two measurements, and cone_resistance "
                                             "goes first; leave out the one that is not meant",
                                             law_.model));
      return true;
    }
    return !node_.has("blow_count") && kept_value("cone_resistance") != nullptr;
  }
  // What this model has no use for and another might have.
  void keep_measurements() {
    for (const auto& [key, highest] :
         {std::pair{"blow_count", 60.0}, {"cone_resistance", 50e6}, {"fines_content", 100.0}}) {
      if (law_.record.contains(key)) continue;
      const Range range = Range::between(0.0, highest);
      if (const auto given = node_.number_if(key, "1", range))
        law_.record[key] = *given;
      else if (const Json* before = kept_ ? find_kept(key) : nullptr)
        law_.record[key] = *before;
    }
  }
  const CaseNode& node() const { return node_; }

 private:
  template <class T>
  T keep(const std::string& key, T value) {
    law_.record[key] = value;
    return value;
  }

  const Json* find_kept(const std::string& key) const {
    const auto found = kept_->record.find(key);
    return found == kept_->record.end() ? nullptr : &*found;
  }

  // The kept law's value of `key` where it means the same for the model of this one.
  const Json* kept_value(const std::string& key) const {
    const Json* found = kept_ ? find_kept(key) : nullptr;
    if (!found || kept_model_ == law_.model) return found;
    static const std::vector<std::string> of_no_model = {"percentile",          "blow_count",      "fines_content",
                                                         "void_redistribution", "drained_cap",     "friction_angle",
                                                         "minimum_ratio",       "minimum_strength"};
    if (key == "cone_resistance") {
      const std::string then = meanings_of(kept_model_).cone_resistance, now = meanings_of(law_.model).cone_resistance;
      return then.empty() || then == now ? found : nullptr;
    }
    return std::find(of_no_model.begin(), of_no_model.end(), key) == of_no_model.end() ? nullptr : found;
  }

  std::optional<double> kept_number(const std::string& key, Range range) {
    const Json* before = kept_value(key);
    if (!before) return std::nullopt;
    if (!before->is_number() || !range.contains(before->get<double>()))
      refuse_kept(key, fmt::format("a number in {} is required", range.text()));
    const std::string then = meanings_of(kept_model_).blow_count, now = meanings_of(law_.model).blow_count;
    if (key == "blow_count" && !node_.has(key) && !then.empty() && then != now)
      law_.warnings.push_back(fmt::format("blow_count = {:g} was meant as {} ({}), {} takes {}", before->get<double>(),
                                          then, kept_model_, law_.model, now));
    return before->get<double>();
  }

  std::optional<std::vector<double>> kept_numbers(const std::string& key, Range range) {
    const Json* before = kept_value(key);
    if (!before) return std::nullopt;
    const auto fits = [&range](const Json& x) { return x.is_number() && range.contains(x.get<double>()); };
    if (!before->is_array() || !std::all_of(before->begin(), before->end(), fits))
      refuse_kept(key, fmt::format("numbers in {} are required", range.text()));
    return before->get<std::vector<double>>();
  }

  [[noreturn]] void refuse_kept(const std::string& key, const std::string& wanted) const {
    throw InputError(fmt::format("{}: '{}' is {}, but {}", kept_->place, key, find_kept(key)->dump(), wanted));
  }

  // At the hand-over CaseNode's own words do.
  void say_missing(const std::string& key) const {
    if (!kept_ || node_.has(key)) return;
    node_.fail(key, fmt::format(
                        "missing: the model '{}' needs it, and {}", law_.model,
                        kept_model_.empty()
                            ? kept_->place
                            : fmt::format("the law of the hand-over ('{}') has none that it could take", kept_model_)));
  }

  const CaseNode& node_;
  StrengthLaw& law_;
  const KeptStrengthLaw* kept_;
  std::string kept_model_;
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
                                        strengths.size(), strengths.empty() ? 0 : strengths.size() - 1));
  if (std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) != edges.end())
    in.node().fail("edges", "the edges must increase");
  law.evaluate_model = [edges, strengths](double sigma) {
    return strengths[static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), sigma) - edges.begin())];
  };
}

void read_idriss_boulanger(Inputs& in, StrengthLaw& law) {
  const bool redistribution = in.boolean_or("void_redistribution", true);
  const double fines = in.number_or("fines_content", "%", Range::between(0.0, 100.0), 0.0);
  double ratio = 0.0;
  if (in.has_cone()) {
    const double q = in.number("cone_resistance", "1", Range::between(0.0, 200.0)) + fines_increment_cpt(fines);
    if (q > 90.0) law.warnings.push_back(fmt::format("q_c1Ncs-Sr = {:g} lies above the case histories' 90", q));
    check_normalised_cone(in.node(), "cone_resistance", "q_c1N");
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
  if (in.has_cone()) {
    const double q = in.number("cone_resistance", "Pa", Range::between(0.0, 50e6));
    check_cone_stress(in.node(), "cone_resistance");
    if (q > 6.5e6) law.warnings.push_back(fmt::format("q_c1 = {:g} MPa lies above the correlation's 6.5", q / 1e6));
    ratio = olson_stark_cpt_ratio(q, z);
  } else {
    ratio = olson_stark_spt_ratio(in.blows(12.0), z);
  }
  law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
}

void read_robertson(Inputs& in, StrengthLaw& law, bool is_2010) {
  const double q = in.number("cone_resistance", "1", Range::between(0.0, is_2010 ? 70.0 : 80.0));
  check_normalised_cone(in.node(), "cone_resistance", "Q_tn,cs");
  const double ratio = is_2010 ? robertson_2010_ratio(q) : robertson_2022_ratio(q);
  law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
}

void read_model(Inputs& in, StrengthLaw& law) {
  if (law.model == "table") {
    read_table(in, law);
  } else if (law.model == "bins") {
    read_bins(in, law);
  } else if (law.model == "seed_fit") {
    const double n = in.number_or("blow_count", "1", Range::between(0.0, 60.0), 6.0);
    if (n != 6.0) law.warnings.push_back(fmt::format("seed_fit was fitted for N60cs = 6, used with {:g}", n));
    law.evaluate_model = [n](double sigma) { return seed_fit(n, sigma); };
  } else if (law.model == "weber") {
    const double n = in.blows(blows_of_case_histories), z = in.percentile();
    law.evaluate_model = [n, z](double sigma) { return weber_2015(n, sigma, z); };
  } else if (law.model == "kramer_wang") {
    const double n = in.blows(blows_of_case_histories), z = in.percentile();
    law.evaluate_model = [n, z](double sigma) { return kramer_wang_2015(n, sigma, z); };
  } else if (law.model == "idriss_boulanger") {
    read_idriss_boulanger(in, law);
  } else if (law.model == "olson_stark") {
    read_olson_stark(in, law);
  } else if (law.model == "robertson_2010" || law.model == "robertson_2022") {
    read_robertson(in, law, law.model == "robertson_2010");
  } else if (law.model == "ratio") {
    const double ratio = in.number("ratio", "1", Range::positive());
    check_fraction(in.node(), "ratio");
    law.domain.second = 1e300;
    law.evaluate_model = [ratio](double sigma) { return ratio * sigma; };
  } else {
    const double strength = in.number("strength", "Pa", Range::positive());
    check_residual_strength(in.node(), "strength", strength);
    law.domain.second = 1e300;
    law.evaluate_model = [strength](double) { return strength; };
  }
}

void read_bounds(Inputs& in, StrengthLaw& law) {
  law.drained_cap = in.boolean_or("drained_cap", law.drained_cap);
  law.friction_angle = in.number_or("friction_angle", "deg", Range::open(0.0, 60.0), law.friction_angle);
  check_angle(in.node(), "friction_angle", law.friction_angle);
  law.minimum_ratio = in.number_or("minimum_ratio", "1", Range::non_negative(), law.minimum_ratio);
  check_fraction(in.node(), "minimum_ratio");
  law.minimum_strength = in.number_or("minimum_strength", "Pa", Range::positive(), law.minimum_strength);
}

// The factor of the law that is changed, as long as its model stays.
double kept_factor(const KeptStrengthLaw& kept, const StrengthLaw& law) {
  const auto found = kept.record.find("factor");
  if (found == kept.record.end() || kept.record.value("model", "") != law.model) return 1.0;
  if (!found->is_number() || !(found->get<double>() > 0.0))
    throw InputError(fmt::format("{}: 'factor' is {}, but a number above 0 is required", kept.place, found->dump()));
  return found->get<double>();
}

}  // namespace

const std::vector<std::string>& strength_models() {
  static const std::vector<std::string> models = {
      "table",       "bins",           "seed_fit",       "weber", "kramer_wang", "idriss_boulanger",
      "olson_stark", "robertson_2010", "robertson_2022", "ratio", "constant"};
  return models;
}

const std::vector<std::string>& strength_law_keys() {
  static const std::vector<std::string> keys = {"model",
                                                "percentile",
                                                "blow_count",
                                                "cone_resistance",
                                                "fines_content",
                                                "strength",
                                                "void_redistribution",
                                                "ratio",
                                                "edges",
                                                "strengths",
                                                "drained_cap",
                                                "friction_angle",
                                                "minimum_ratio",
                                                "minimum_strength",
                                                "initial_vertical_effective_stress"};
  return keys;
}

bool has_percentile(const std::string& model) {
  return model == "weber" || model == "kramer_wang" || model == "olson_stark";
}

StrengthLaw read_strength_law(const CaseNode& node) {
  StrengthLaw law;
  law.model = node.choice("model", strength_models());
  law.record["model"] = law.model;
  law.domain = {0.0, stress_of_case_histories};
  Inputs in(node, law, nullptr);
  read_model(in, law);
  law.factor = in.number_or("factor", "1", Range::positive(), law.factor);
  check_factor(node, "factor", law.factor);
  read_bounds(in, law);
  in.keep_measurements();
  check_fines_content(node, "fines_content");
  return law;
}

StrengthLaw read_changed_strength_law(const CaseNode& node, const KeptStrengthLaw& kept, const std::string& model) {
  StrengthLaw law;
  Inputs in(node, law, &kept);
  const auto& models = strength_models();
  if (model.empty() && in.kept_model().empty() && !node.has("model"))
    node.fail("model", fmt::format("missing: {}. Allowed is one of {}", kept.place, joined(models)));
  if (!in.kept_model().empty() && std::find(models.begin(), models.end(), in.kept_model()) == models.end())
    throw InputError(
        fmt::format("{}: model '{}' is not known; known are {}", kept.place, in.kept_model(), joined(models)));
  law.model = !model.empty()            ? model
              : in.kept_model().empty() ? node.choice("model", models)
                                        : node.choice_or("model", models, in.kept_model());
  law.record["model"] = law.model;
  law.domain = {0.0, stress_of_case_histories};
  read_model(in, law);
  law.factor = law.record["factor"] = kept_factor(kept, law);
  read_bounds(in, law);
  in.keep_measurements();
  check_fines_content(node, "fines_content");
  return law;
}

}  // namespace tailrun

#include "transfer_tool/assign/rules.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/plausible_material.hpp"
#include "common/residual_strength/strength_tally.hpp"

namespace tailrun::transfer {
namespace {

struct QuantityName {
  Quantity quantity;
  const char* name;
  const char* unit;
};

constexpr QuantityName quantities[] = {
    {Quantity::x, "x", "m"},
    {Quantity::y, "y", "m"},
    {Quantity::depth, "depth", "m"},
    {Quantity::excess_pore_pressure_ratio, "excess_pore_pressure_ratio", "1"},
    {Quantity::initial_vertical_effective_stress, "initial_vertical_effective_stress", "Pa"},
    {Quantity::shear_strain, "shear_strain", "1"},
};

double value_of(Quantity quantity, const SamplePoints& points, const PointState& state, std::size_t p) {
  switch (quantity) {
    case Quantity::x:
      return points.initial_position[2 * p];
    case Quantity::y:
      return points.initial_position[2 * p + 1];
    case Quantity::depth:
      return state.depth[p];
    case Quantity::excess_pore_pressure_ratio:
      return state.excess_pore_pressure_ratio[p];
    case Quantity::initial_vertical_effective_stress:
      return state.initial_vertical_effective_stress[p];
    case Quantity::shear_strain:
      return state.shear_strain[p];
  }
  return 0.0;
}

Range read_range(const CaseNode& node, const std::string& key, const char* unit) {
  const CaseNode bounds = node.object(key);
  const auto above = bounds.number_if("above", unit, Range::any());
  const auto at_least = bounds.number_if("at_least", unit, Range::any());
  const auto below = bounds.number_if("below", unit, Range::any());
  const auto at_most = bounds.number_if("at_most", unit, Range::any());
  if ((above && at_least) || (below && at_most) || (!above && !at_least && !below && !at_most))
    node.fail(key, "one of 'above' and 'at_least', one of 'below' and 'at_most', or one of either, is required");
  Range range;
  if (above || at_least) range.low = above ? *above : *at_least;
  if (below || at_most) range.high = below ? *below : *at_most;
  range.low_open = above.has_value();
  range.high_open = below.has_value();
  if (range.low > range.high) node.fail(key, fmt::format("the interval {} is empty", range.text()));
  // r_u seldom passes 1.2: a bound above 2 is a percentage, and no point would ever be beyond it.
  if (key == "excess_pore_pressure_ratio" && std::isfinite(range.low) && range.low > 2.0)
    bounds.warn(above ? "above" : "at_least",
                fmt::format("{:g}; r_u is a ratio, {:g} % are {:g}", range.low, range.low, 0.01 * range.low));
  if (key == "initial_vertical_effective_stress")
    for (const char* word : {"above", "at_least", "below", "at_most"}) check_ground_stress(bounds, word);
  return range;
}

// The particles file lists only materials that have particles, so that the particle stage asks for no others; the
// order of the rules is kept.
void drop_unused_materials(Assignment& assignment) {
  std::vector<std::int32_t> new_id(assignment.material_names.size(), -1);
  for (const std::int32_t id : assignment.material_id) new_id[static_cast<std::size_t>(id)] = 0;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < new_id.size(); ++m) {
    if (new_id[m] < 0) continue;
    new_id[m] = static_cast<std::int32_t>(names.size());
    names.push_back(assignment.material_names[m]);
  }
  for (std::int32_t& id : assignment.material_id) id = new_id[static_cast<std::size_t>(id)];
  assignment.material_names = std::move(names);
}

nlohmann::ordered_json record_of(const Rule& rule, const StrengthTally& tally, long points) {
  nlohmann::ordered_json record = {{"material", rule.material}, {"points", points}};
  if (!rule.strength) return record;
  auto strength = rule.strength->record;
  strength["capped_by_drained_strength"] = tally.capped;
  strength["raised_to_lower_bound"] = tally.raised;
  strength["outside_of_domain"] = tally.outside;
  if (tally.count > 0) {
    strength["smallest_Pa"] = tally.strength.least;
    strength["mean_Pa"] = tally.strength.sum / static_cast<double>(tally.count);
    strength["largest_Pa"] = tally.strength.most;
  }
  record["residual_strength"] = strength;
  return record;
}

}  // namespace

std::int32_t region_index(const CaseNode& node, const std::string& key, const std::string& name,
                          const std::vector<std::string>& region_names) {
  const auto place = std::find(region_names.begin(), region_names.end(), name);
  if (place == region_names.end())
    node.fail(key, fmt::format("the snapshot has no region '{}'.{} It has: {}", name, did_you_mean(name, region_names),
                               joined(region_names)));
  return static_cast<std::int32_t>(place - region_names.begin());
}

Condition read_condition(const CaseNode& node, const std::vector<std::string>& region_names) {
  Condition condition;
  for (const auto& name : node.is_list("region") || !node.has("region") ? node.texts_or("region", {})
                                                                        : std::vector<std::string>{node.text("region")})
    condition.regions.push_back(region_index(node, "region", name, region_names));
  for (const auto& [quantity, name, unit] : quantities)
    if (node.has(name)) condition.bounds.push_back({quantity, read_range(node, name, unit)});
  for (const auto& part : node.list_or_empty("any")) condition.any.push_back(read_condition(part, region_names));
  for (const auto& part : node.list_or_empty("all")) condition.all.push_back(read_condition(part, region_names));
  for (const auto& part : node.list_or_empty("none")) condition.none.push_back(read_condition(part, region_names));
  return condition;
}

std::vector<Rule> read_rules(const std::vector<CaseNode>& nodes, const std::vector<std::string>& region_names) {
  std::vector<Rule> rules;
  for (const auto& node : nodes) {
    Rule rule{node.text("material"), read_condition(node.object_or_empty("when"), region_names), std::nullopt};
    if (rule.material.empty()) node.fail("material", "the name is empty");
    if (const auto strength = node.object_if("residual_strength")) rule.strength = read_strength_law(*strength);
    rules.push_back(std::move(rule));
  }
  return rules;
}

bool holds(const Condition& condition, std::int32_t region, const SamplePoints& points, const PointState& state,
           std::size_t p) {
  const auto& regions = condition.regions;
  if (!regions.empty() && std::find(regions.begin(), regions.end(), region) == regions.end()) return false;
  for (const auto& bound : condition.bounds)
    if (!bound.range.contains(value_of(bound.quantity, points, state, p))) return false;
  const auto part_holds = [&](const Condition& part) { return holds(part, region, points, state, p); };
  return std::all_of(condition.all.begin(), condition.all.end(), part_holds) &&
         std::none_of(condition.none.begin(), condition.none.end(), part_holds) &&
         (condition.any.empty() || std::any_of(condition.any.begin(), condition.any.end(), part_holds));
}

Assignment assign(const Snapshot& snapshot, const SamplePoints& points, const PointState& state,
                  const std::vector<Rule>& rules) {
  Assignment result;
  const auto material = [&](const std::string& name) {
    auto& names = result.material_names;
    const auto place = std::find(names.begin(), names.end(), name);
    const auto id = static_cast<std::int32_t>(place - names.begin());
    if (place == names.end()) names.push_back(name);
    return id;
  };
  // Names in the rules' order, so that ids do not depend on which point comes first; laws likewise.
  std::vector<std::int32_t> id_of_rule, law_of_rule;
  for (const auto& rule : rules) {
    id_of_rule.push_back(material(rule.material));
    law_of_rule.push_back(rule.strength ? static_cast<std::int32_t>(result.strength_laws.size()) : -1);
    if (rule.strength) result.strength_laws.push_back(text_of_json(rule.strength->record));
  }

  std::vector<StrengthTally> tallies(rules.size());
  std::vector<long> matches(rules.size(), 0);
  std::map<std::int32_t, long> unmatched;
  for (std::size_t p = 0; p < points.count(); ++p) {
    const std::int32_t region = snapshot.region_id[static_cast<std::size_t>(points.element[p])];
    std::size_t r = 0;
    while (r < rules.size() && !holds(rules[r].when, region, points, state, p)) ++r;
    if (r == rules.size()) {
      ++unmatched[region];
      continue;
    }
    ++matches[r];
    Strength strength;
    if (rules[r].strength) {
      strength = (*rules[r].strength)(state.initial_vertical_effective_stress[p]);
      tallies[r].add(state.initial_vertical_effective_stress[p], strength);
    }
    result.material_id.push_back(id_of_rule[r]);
    result.strength_law.push_back(law_of_rule[r]);
    result.residual_strength.push_back(strength.value);
  }
  if (!unmatched.empty()) {
    std::vector<std::string> where;
    for (const auto& [region, count] : unmatched)
      where.push_back(fmt::format("{} in '{}'", count, snapshot.region_names[static_cast<std::size_t>(region)]));
    throw InputError(fmt::format(
        "/rules: points that no rule fits: {}. End the list with a rule for the rest of each region", joined(where)));
  }

  drop_unused_materials(result);
  std::vector<bool> has_points(snapshot.region_names.size(), false);
  for (const std::int64_t element : points.element)
    has_points[static_cast<std::size_t>(snapshot.region_id[static_cast<std::size_t>(element)])] = true;
  const auto is_present = [&](std::int32_t region) { return has_points[static_cast<std::size_t>(region)]; };
  result.record = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < rules.size(); ++r) {
    result.matches.push_back(matches[r]);
    result.record.push_back(record_of(rules[r], tallies[r], matches[r]));
    const auto& asked = rules[r].when.regions;
    // A rule for regions that are left out altogether is there for the day when they are not.
    if (matches[r] == 0 && (asked.empty() || std::any_of(asked.begin(), asked.end(), is_present)))
      result.warnings.push_back(fmt::format("rule {} (material '{}') fits no point", r, rules[r].material));
    if (!rules[r].strength) continue;
    for (const auto& warning : tallies[r].warnings(*rules[r].strength))
      result.warnings.push_back(fmt::format("rule {} ({}): {}", r, rules[r].strength->model, warning));
  }
  return result;
}

}  // namespace tailrun::transfer

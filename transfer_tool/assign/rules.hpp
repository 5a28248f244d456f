// Step 3 of the hand-over: ordered rules give every point its material; the first rule that holds wins.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "common/residual_strength/strength_law.hpp"
#include "common/snapshot.hpp"
#include "transfer_tool/map/map_state.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace tailrun::transfer {

// What a condition may ask of a point. Positions are those of the undeformed mesh.
enum class Quantity { x, y, depth, excess_pore_pressure_ratio, initial_vertical_effective_stress, shear_strain };

struct Bound {
  Quantity quantity;
  Range range;
};

// All parts hold: the region is among `regions` (any when empty), every bound, every condition of `all`, at least one
// of `any` (when there are some), and none of `none`.
struct Condition {
  std::vector<std::int32_t> regions;
  std::vector<Bound> bounds;
  std::vector<Condition> any, all, none;
};

struct Rule {
  std::string material;
  Condition when;
  std::optional<StrengthLaw> strength;
};

// Reads {"region": ..., "<quantity>": {"above"|"at_least"|"below"|"at_most": ...}, "any": [...], "all": [...],
// "none": [...]}. Throws InputError; an unknown region is answered with the nearest name.
Condition read_condition(const CaseNode& node, const std::vector<std::string>& region_names);
std::vector<Rule> read_rules(const std::vector<CaseNode>& nodes, const std::vector<std::string>& region_names);

// Index of `name`; throws InputError at node/key with the nearest name.
std::int32_t region_index(const CaseNode& node, const std::string& key, const std::string& name,
                          const std::vector<std::string>& region_names);

struct Assignment {
  std::vector<std::string> material_names;
  std::vector<std::int32_t> material_id;
  std::vector<double> residual_strength;   // Pa, 0 where the rule has none
  std::vector<std::int32_t> strength_law;  // index into strength_laws, -1 where the rule has none
  std::vector<std::string> strength_laws;  // JSON, as StrengthLaw::record
  std::vector<long> matches;               // points by rule
  std::vector<std::string> warnings;
  nlohmann::ordered_json record;  // rules, models, inputs, percentiles, bound hits
};

bool holds(const Condition& condition, std::int32_t region, const SamplePoints& points, const PointState& state,
           std::size_t point);

// Throws InputError when a point fits no rule: tells regions and counts.
Assignment assign(const Snapshot& snapshot, const SamplePoints& points, const PointState& state,
                  const std::vector<Rule>& rules);

}  // namespace tailrun::transfer

#include "fem_stage/model/boundary_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <string>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

Place read_place(const CaseNode& node) {
  Place place;
  place.where = node.pointer();
  if (node.has("line") == node.has("point")) node.fail("", "give either 'line' (a name) or 'point' ([x, y], m)");
  if (node.has("line")) {
    place.line = node.text("line");
  } else {
    const auto xy = node.numbers("point", "m", Range::any(), 2);
    place.point = {xy[0], xy[1]};
  }
  return place;
}

When read_when(const CaseNode& node) {
  const std::string word = node.choice_or("stage", {"both", "geostatic", "shake"}, "both");
  if (word == "geostatic") return When::geostatic;
  return word == "shake" ? When::shake : When::both;
}

FixedFreedoms read_fixed(const CaseNode& node) {
  FixedFreedoms out;
  out.place = read_place(node);
  const auto words = node.texts_or("freedoms", {"x", "y"});
  if (words.empty()) node.fail("freedoms", "an empty list; allowed are x, y, p");
  for (const auto& word : words) {
    if (word == "x")
      out.x = true;
    else if (word == "y")
      out.y = true;
    else if (word == "p")
      out.p = true;
    else
      node.fail("freedoms", fmt::format("found '{}', but allowed are x, y, p", word));
  }
  out.when = read_when(node);
  return out;
}

TimeHistory read_history(const CaseNode& load) {
  const auto node = load.object_if("history");
  if (!node) return {};
  const std::string type = node->choice("type", {"constant", "ramp", "ricker", "sine", "csv"});
  if (type == "ramp")
    return TimeHistory::ramp(node->number_or("start", "s", Range::non_negative(), 0.0),
                             node->number("duration", "s", Range::non_negative()));
  if (type == "ricker")
    return TimeHistory::ricker(node->number("frequency", "Hz", Range::positive()),
                               node->number("delay", "s", Range::any()));
  if (type == "sine")
    return TimeHistory::sine(node->number("frequency", "Hz", Range::positive()),
                             node->number_or("start", "s", Range::any(), 0.0));
  return type == "csv" ? TimeHistory::table(node->file("file")) : TimeHistory();
}

void read_base(const CaseNode& base, BoundaryOptions& out) {
  out.base_line = base.text("line");
  out.base = base.choice("type", {"lysmer_dashpot", "rigid"}) == "rigid" ? BaseKind::rigid : BaseKind::lysmer_dashpot;
  if (out.base == BaseKind::rigid) return;
  out.rock_density = base.number("rock_density", "kg/m3", Range::positive());
  out.rock_shear_velocity = base.number("rock_shear_velocity", "m/s", Range::positive());
  out.base_tied = base.boolean_or("tied", false);
  if (base.choice_or("vertical", {"fixed", "dashpot"}, "fixed") == "dashpot")
    out.rock_p_velocity = base.number("rock_p_velocity", "m/s", Range::positive());
}

}  // namespace

BoundaryOptions read_boundaries(const CaseNode& node) {
  BoundaryOptions out;
  if (const auto base = node.object_if("base")) read_base(*base, out);
  out.tied_column_regions = node.texts_or("tied_column_regions", {});
  out.periodic_lines = node.texts_or("periodic_lines", {});
  out.roller_lines = node.texts_or("roller_lines", {});
  out.geostatic_roller_lines = node.texts_or("geostatic_roller_lines", {});
  for (const auto& item : node.list_or_empty("fixed")) out.fixed.push_back(read_fixed(item));
  for (const auto& line : node.texts_or("drained_lines", {}))
    out.held_pressure.push_back({line, {}, "/boundaries/drained_lines"});
  for (const auto& item : node.list_or_empty("held_pressure")) {
    HeldPressure held{item.text("line"), {}, item.pointer()};
    const auto field = item.numbers("pressure", "Pa, Pa/m, Pa/m", Range::any());
    if (field.size() != 1 && field.size() != 3)
      item.fail("pressure", "one value [Pa], or three (at the origin [Pa], along x and y [Pa/m]), are required");
    std::copy(field.begin(), field.end(), held.field.begin());
    out.held_pressure.push_back(std::move(held));
  }
  std::set<std::string> flooded;
  for (const auto& item : node.list_or_empty("ponded_water")) {
    Pond pond{item.texts_or("lines", {}), item.number("level", "m", Range::any()), item.pointer()};
    if (pond.lines.empty()) item.fail("lines", "at least one line of the ground under water is required");
    for (const std::string& line : pond.lines) {
      if (!flooded.insert(line).second)
        item.fail("lines", fmt::format("line '{}' is under water twice, and would be pressed twice", line));
    }
    out.ponds.push_back(std::move(pond));
  }
  for (const auto& item : node.list_or_empty("free_field_dashpots")) {
    FreeFieldSide side{item.text("line"), item.text("column_line"), 0.0, 0.0, 0.0, item.pointer()};
    side.density = item.number_or("density", "kg/m3", Range::non_negative(), 0.0);
    side.shear_velocity = item.number_or("shear_velocity", "m/s", Range::non_negative(), 0.0);
    side.p_velocity = item.number_or("p_velocity", "m/s", Range::non_negative(), 0.0);
    out.free_field.push_back(std::move(side));
  }
  return out;
}

std::vector<LoadOptions> read_loads(const CaseNode& root) {
  std::vector<LoadOptions> loads;
  for (const auto& node : root.list_or_empty("loads")) {
    LoadOptions load;
    load.place = read_place(node);
    if (load.place.line.empty()) {
      const auto force = node.numbers("force", "N", Range::any(), 2);
      load.traction = {force[0], force[1]};
    } else {
      if (node.has("traction") == node.has("pressure"))
        node.fail("", "give either 'traction' ([x, y], Pa) or 'pressure' (Pa, against the outward normal)");
      if (node.has("traction")) {
        const auto traction = node.numbers("traction", "Pa", Range::any(), 2);
        load.traction = {traction[0], traction[1]};
      } else {
        load.pressure = node.number("pressure", "Pa", Range::any());
      }
    }
    load.when = read_when(node);
    load.history = read_history(node);
    if (!load.history.constant() && load.when != When::shake)
      node.fail("stage", "a load that changes with time acts in the shaking only: 'shake' is required");
    loads.push_back(std::move(load));
  }
  return loads;
}

}  // namespace tailrun::fem

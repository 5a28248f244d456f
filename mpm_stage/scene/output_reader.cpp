// "output" of mpm.json. Whether what it names lies where there is soil is judged later (output/place_checks.hpp).
#include <fmt/core.h>

#include <algorithm>

#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// A name that is a column's, and no other's among those read so far.
template <class Named>
std::string read_name(const CaseNode& node, const std::vector<Named>& others, const char* what) {
  const std::string name = node.text("name");
  require_column_word(node, "name", name);
  for (const Named& other : others)
    if (other.name == name) node.fail("name", fmt::format("there is a {} '{}' already", what, name));
  return name;
}

}  // namespace

void read_output(const CaseNode& root, Scene& scene) {
  const CaseNode node = root.object_or_empty("output");
  OutputOptions& o = scene.output;
  o.frame_interval = node.number_or("frame_interval", "s", Range::non_negative(), o.frame_interval);
  o.frame_precision = node.choice_or("frame_precision", {"double", "single"}, "double") == "single" ? Precision::single
                                                                                                    : Precision::full;
  o.series_interval = node.number_or("series_interval", "s", Range::positive(), o.series_interval);
  for (const auto& [key, interval] :
       {std::pair{"frame_interval", o.frame_interval}, std::pair{"series_interval", o.series_interval}})
    if (node.has(key) && interval > scene.end_time)
      node.warn(key,
                fmt::format("{0:g} s is longer than the run (/time/end, {1:g} s): there is nothing between its start "
                            "and its end; {0:g} ms are {2:g} s",
                            interval, scene.end_time, 1e-3 * interval));
  const std::string direction = node.choice_or("front_direction", {"+x", "-x", "+y", "-y", "+z", "-z"}, "+x");
  o.front_sign = direction[0] == '+' ? 1.0 : -1.0;
  o.front_axis = direction[1] - 'x';
  if (o.front_axis >= scene.dimension) node.fail("front_direction", "z needs dimension 3");
  o.flow_distance = node.number_or("flow_distance", "m", Range::positive(), o.flow_distance);
  o.front_quantile = node.number_or("front_quantile", "1", Range::between(0.5, 1.0), o.front_quantile);
  o.body_quantile = node.number_or("body_quantile", "1", Range::between(0.5, o.front_quantile),
                                   std::min(o.body_quantile, o.front_quantile));
  o.toe = node.number_if("toe", "m", Range::any());
  if (node.has("footprint")) {
    const auto ends = node.numbers("footprint", "m", Range::any(), 2);
    if (!(ends[0] < ends[1])) node.fail("footprint", "the first number must be below the second");
    o.footprint = {ends[0], ends[1]};
  }
  for (const CaseNode& point : node.list_or_empty("points")) {
    const auto x = point.numbers("position", "m", Range::any(), 2);
    const std::string name = read_name(point, o.points, "point");
    if (name == "centre")
      point.fail("name", "'centre' has its columns in front.csv already: they are the soil's centre");
    o.points.push_back({name, {x[0], x[1]}});
  }
  for (const CaseNode& section : node.list_or_empty("sections")) {
    const std::string name = read_name(section, o.sections, "section");
    o.sections.push_back({name, section.number("at", "m", Range::any())});
  }
}

}  // namespace tailrun::mpm

#include "transfer_tool/options/transfer_case.hpp"

#include <fmt/core.h>

#include "common/plain_names.hpp"

namespace tailrun::transfer {
namespace {

Recovery read_recovery(const CaseNode& node, const std::string& key, const std::string& fallback) {
  const std::string word = node.choice_or(key, {"element", "nodal", "linear"}, fallback);
  return word == "element" ? Recovery::element : word == "nodal" ? Recovery::nodal : Recovery::linear;
}

int read_points(const CaseNode& node, const std::string& key, Layout layout, int fallback) {
  if (!node.has(key)) return fallback;
  if (!node.is_number(key)) {
    node.choice(key, {"automatic"});
    return 0;
  }
  return static_cast<int>(node.integer(key, 1, layout == Layout::gauss ? 5 : 50));
}

void read_sampling(const CaseNode& node, const std::vector<std::string>& region_names, SamplingOptions& sampling) {
  sampling.layout =
      node.choice_or("layout", {"gauss", "uniform"}, "gauss") == "gauss" ? Layout::gauss : Layout::uniform;
  sampling.inverted = node.choice_or("inverted_elements", {"error", "initial_volume"}, "error") == "error"
                          ? InvertedElements::error
                          : InvertedElements::initial_volume;
  sampling.cell_size = node.number_or("cell_size", "m", Range::positive(), 1.0);
  sampling.points_per_cell = node.number_or("points_per_cell", "1", Range::between(0.5, 100.0), 4.0);
  const int everywhere = read_points(node, "points", sampling.layout, 0);
  sampling.points.assign(region_names.size(), everywhere);
  // The names of the regions are the only keys asked for, so that another one is an unknown key.
  const CaseNode by_region = node.object_or_empty("points_by_region");
  for (std::size_t i = 0; i < region_names.size(); ++i)
    sampling.points[i] = read_points(by_region, region_names[i], sampling.layout, everywhere);
}

void read_regions(const CaseNode& root, const std::vector<std::string>& region_names, TransferCase& result) {
  auto& kept = result.sampling.kept_region;
  kept.assign(region_names.size(), true);
  for (const auto& name : root.texts_or("exclude", {}))
    kept[static_cast<std::size_t>(region_index(root, "exclude", name, region_names))] = false;
  const CaseNode clip = root.object_or_empty("clip");
  const auto interval = [&](const std::string& key, std::array<double, 2>& bounds) {
    if (!clip.has(key)) return;
    const auto values = clip.numbers(key, "m", Range::any(), 2);
    if (values[0] >= values[1]) clip.fail(key, "the first number must be below the second");
    bounds = {values[0], values[1]};
  };
  interval("x", result.sampling.clip_x);
  interval("y", result.sampling.clip_y);

  const auto node = root.object_if("terrain");
  result.terrain.region.assign(region_names.size(), false);
  if (!node) return;
  for (const auto& name : node->texts_or("regions", {})) {
    const auto region = static_cast<std::size_t>(region_index(*node, "regions", name, region_names));
    result.terrain.region[region] = true;
    kept[region] = false;
  }
  result.terrain.name = node->text_or("name", "bed");
  require_dataset_name(*node, "name", result.terrain.name, "the particles file, as a dataset's name");
  // Those of the walls (sample/terrain.cpp): one of two lines of one name would be lost.
  if (result.terrain.name == "upstream_wall" || result.terrain.name == "downstream_wall")
    node->fail("name", fmt::format("found '{}', which is a wall's name; give the bed another", result.terrain.name));
  if (const auto to = node->number_if("downstream_to", "m", Range::any())) {
    if (!result.terrain.any()) node->fail("downstream_to", "there is no bed to extend: 'regions' names none");
    result.terrain.extend = true;
    result.terrain.downstream_to = *to;
  }
  result.terrain.walls = node->boolean_or("walls", false);
  if (!result.terrain.any() && !result.terrain.walls)
    node->fail("regions", "name at least one region that is to be the bed, or set 'walls' to true");
  result.terrain.wall_height = node->number_or("wall_height", "m", Range::non_negative(), 10.0);
  result.terrain.downstream_slope = node->number_or("downstream_slope", "deg", Range::open(-80.0, 80.0), 0.0);
}

MapOptions read_state(const CaseNode& node) {
  MapOptions state;
  state.stress = read_recovery(node, "stress", "element");
  state.initial_stress = read_recovery(node, "initial_vertical_effective_stress", "linear");
  state.pressure_ratio = read_recovery(node, "excess_pore_pressure_ratio", "element");
  state.maximum_pressure_ratio =
      node.choice_or("pressure_ratio_time", {"at_transfer", "maximum_so_far"}, "at_transfer") == "maximum_so_far";
  state.depth_of_point = node.choice_or("depth", {"point", "element"}, "point") == "point";
  state.remove_base_motion = node.choice_or("base_motion", {"remove", "keep"}, "remove") == "remove";
  state.equilibrate = node.boolean_or("equilibrate", false);
  return state;
}

}  // namespace

TransferCase read_transfer_case(const CaseFile& file, const std::vector<std::string>& region_names,
                                const std::string& size) {
  const CaseNode root = file.root();
  TransferCase result;
  result.transfer_time = root.number_if("transfer_time", "s", Range::non_negative());
  read_sampling(root.object_or_empty("sampling"), region_names, result.sampling);
  require_size(root, size);
  for (const auto& [name, node] : root.object_or_empty("sizes").members()) {
    const auto cell_size = node.number_if("cell_size", "m", Range::positive());
    if (name == size && cell_size) result.sampling.cell_size = *cell_size;
  }
  read_regions(root, region_names, result);
  result.state = read_state(root.object_or_empty("state"));
  result.rules = read_rules(root.list("rules"), region_names);
  if (result.rules.empty()) root.fail("rules", "the list is empty; every point needs a rule that fits it");
  file.finish();
  return result;
}

}  // namespace tailrun::transfer

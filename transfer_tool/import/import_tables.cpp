#include "transfer_tool/import/import_tables.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "common/element_mean.hpp"
#include "common/error.hpp"
#include "common/plain_names.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_surroundings.hpp"
#include "common/plausible_voids.hpp"
#include "common/warnings.hpp"
#include "transfer_tool/import/csv_table.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

constexpr double least_stress = 5e3;               // Pa, in the denominator of r_u
constexpr double least_saturation_pressure = 300;  // Pa, initial pore pressure below which a soil counts as dry

using Numbers = std::map<std::int64_t, std::size_t>;  // a table's own number to our index

Numbers numbering(CsvTable& table, const std::string& column) {
  Numbers index;
  const auto numbers = table.integers(column);
  for (std::size_t row = 0; row < numbers.size(); ++row)
    if (!index.emplace(numbers[row], row).second) table.fail(row, column, fmt::format("{} occurs twice", numbers[row]));
  return index;
}

// Rows of a result table in the mesh's own order. Throws InputError for numbers that are missing or unknown.
std::vector<std::size_t> rows_in_order(CsvTable& table, const std::string& column, const Numbers& mesh) {
  std::vector<std::size_t> row_of(mesh.size(), table.rows());
  const auto numbers = table.integers(column);
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    const auto it = mesh.find(numbers[row]);
    if (it == mesh.end()) table.fail(row, column, fmt::format("{} is not in the mesh", numbers[row]));
    if (row_of[it->second] != table.rows())
      table.fail(row, column,
                 fmt::format("{} occurs twice (first in line {}); a table holds one time, so keep the rows of that one",
                             numbers[row], table.line_of(row_of[it->second])));
    row_of[it->second] = row;
  }
  for (const auto& [number, index] : mesh)
    if (row_of[index] == table.rows())
      throw InputError(fmt::format("{}: {} {} of the mesh has no row", table.path().string(), column, number));
  return row_of;
}

std::vector<double> picked(const std::vector<double>& values, const std::vector<std::size_t>& rows) {
  std::vector<double> result;
  result.reserve(rows.size());
  for (const std::size_t row : rows) result.push_back(values[row]);
  return result;
}

std::vector<double> interleaved(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> both(2 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    both[2 * i] = x[i];
    both[2 * i + 1] = y[i];
  }
  return both;
}

void read_mesh(const CaseNode& root, const std::vector<std::string>& ignored, Snapshot& snapshot, Numbers& nodes,
               Numbers& elements) {
  CsvTable node_table(root.file("nodes")), quad_table(root.file("quads"));
  snapshot.position = interleaved(node_table.numbers("x", Quantity::length), node_table.numbers("y", Quantity::length));
  nodes = numbering(node_table, "node");
  elements = numbering(quad_table, "element");
  snapshot.thickness = quad_table.numbers_or("thickness", Quantity::length, 1.0);
  std::array<std::vector<std::int64_t>, 4> corners;
  for (std::size_t a = 0; a < 4; ++a) corners[a] = quad_table.integers(fmt::format("n{}", a + 1));
  const auto regions = quad_table.texts("region");
  for (std::size_t row = 0; row < quad_table.rows(); ++row) {
    for (std::size_t a = 0; a < 4; ++a) {
      const auto it = nodes.find(corners[a][row]);
      if (it == nodes.end())
        quad_table.fail(row, fmt::format("n{}", a + 1), fmt::format("node {} does not exist", corners[a][row]));
      for (std::size_t b = 0; b < a; ++b)
        if (corners[b][row] == corners[a][row])
          quad_table.fail(row, fmt::format("n{}", a + 1),
                          fmt::format("node {} is n{} already; a quadrilateral has four different nodes (triangles are "
                                      "not taken)",
                                      corners[a][row], b + 1));
      snapshot.quads.push_back(static_cast<std::int64_t>(it->second));
    }
    auto& names = snapshot.region_names;
    const auto place = std::find(names.begin(), names.end(), regions[row]);
    snapshot.region_id.push_back(static_cast<std::int32_t>(place - names.begin()));
    if (place == names.end()) names.push_back(regions[row]);
    if (scaled_jacobian(initial_corners(snapshot, row)) <= 0.0)
      quad_table.fail(row, "n1", "the quadrilateral is folded or its nodes run clockwise");
  }
  const bool has_lines = node_table.has("lines");
  node_table.finish(ignored);
  quad_table.finish(ignored);
  if (nodes.empty() || elements.empty())
    throw InputError(fmt::format("{}: has no rows", (nodes.empty() ? node_table : quad_table).path().string()));
  for (std::size_t e = 0; e < snapshot.thickness.size(); ++e)
    if (!(snapshot.thickness[e] > 0.0)) quad_table.fail(e, "thickness", "a thickness must be positive");
  if (!has_lines) return;
  std::map<std::string, std::vector<bool>> on_line;
  const auto lines = node_table.texts("lines");
  for (std::size_t node = 0; node < lines.size(); ++node) {
    std::istringstream names(lines[node]);
    for (std::string name; std::getline(names, name, '|');) {
      if (const std::string fault = fault_as_dataset(name); !fault.empty())
        node_table.fail(
            node, "lines",
            fmt::format("the name {} of a line {}, but it is a dataset's name in snapshots", shown_name(name), fault));
      on_line.try_emplace(name, lines.size(), false).first->second[node] = true;
    }
  }
  for (const auto& [name, is_on] : on_line) {
    MeshLine line{name, {}};
    for (const auto& side : element_sides(snapshot)) {
      if (side.neighbour >= 0 && side.neighbour < side.element) continue;
      if (is_on[static_cast<std::size_t>(side.from)] && is_on[static_cast<std::size_t>(side.to)])
        line.edges.insert(line.edges.end(), {side.from, side.to});
    }
    snapshot.lines.push_back(std::move(line));
  }
}

// (elements, 4) effective stress, tension positive.
std::vector<double> read_stress(CsvTable& table, const std::vector<std::size_t>& rows, double sign) {
  const auto stress_of = [&](const char* name) { return picked(table.numbers(name, Quantity::pressure), rows); };
  const auto xx = stress_of("sxx"), yy = stress_of("syy"), xy = stress_of("sxy");
  const auto zz = table.has("szz") ? stress_of("szz") : std::vector<double>{};
  std::vector<double> stress(4 * rows.size());
  for (std::size_t e = 0; e < rows.size(); ++e) {
    stress[4 * e] = sign * xx[e];
    stress[4 * e + 1] = sign * yy[e];
    stress[4 * e + 2] = sign * (zz.empty() ? 0.5 * (xx[e] + yy[e]) : zz[e]);
    stress[4 * e + 3] = xy[e];
  }
  return stress;
}

void derive_element_fields(Snapshot& snapshot, const std::vector<double>& initial_nodal_pressure) {
  const GroundSurface surface(snapshot);
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    const auto [x, y] = centre(initial_corners(snapshot, e));
    const double pressure = element_mean(snapshot.quads, snapshot.pore_pressure, e);
    const double initial_pressure = element_mean(snapshot.quads, initial_nodal_pressure, e);
    const double initial_vertical = -snapshot.initial_effective_stress[4 * e + 1];
    const double vertical = -snapshot.effective_stress[4 * e + 1];
    for (std::size_t k = 0; k < 4; ++k)
      snapshot.total_stress.push_back(snapshot.effective_stress[4 * e + k] - (k < 3 ? pressure : 0.0));
    snapshot.initial_pore_pressure.push_back(initial_pressure);
    snapshot.initial_vertical_effective_stress.push_back(initial_vertical);
    snapshot.depth.push_back(surface.depth(x, y));
    const double ratio = initial_pressure < least_saturation_pressure
                             ? 0.0
                             : (pressure - initial_pressure) / std::max(initial_vertical, least_stress);
    snapshot.excess_pore_pressure_ratio.push_back(ratio);
    snapshot.max_excess_pore_pressure_ratio.push_back(std::max(ratio, 0.0));
    snapshot.effective_stress_ratio.push_back(1.0 - vertical / std::max(initial_vertical, least_stress));
    snapshot.scaled_jacobian.push_back(scaled_jacobian(deformed_corners(snapshot, e)));
  }
}

// r_u needs the pore pressures before the shaking and sigma'_v0: with one table of the two the other would be taken
// from the state itself, so that r_u would be zero everywhere, or over a stress that the shaking has changed already.
void require_whole_initial_state(const CaseNode& root, double time) {
  const char *nodes = "initial_node_state", *elements = "initial_element_state";
  for (const auto& [given, missing] : {std::pair{nodes, elements}, std::pair{elements, nodes}})
    if (root.has(given) && !root.has(missing))
      root.fail(missing,
                fmt::format("missing, while '{}' is given: the state before the shaking takes both tables, for "
                            "r_u is of its pore pressures and its stresses",
                            given));
  if (time > 0.0 && !root.has(nodes))
    root.warn(nodes,
              fmt::format("missing, with '{}': the state of {:g} s counts as the one before the shaking, so that "
                          "r_u is 0 everywhere and sigma'_v0 is what is left at that time",
                          elements, time));
}

void set_base_velocity(const CaseNode& root, Snapshot& snapshot) {
  const bool given = root.has("base_line");
  const std::string name = root.text_or("base_line", "base");
  std::vector<std::string> names;
  for (const auto& line : snapshot.lines)
    if (!line.edges.empty()) names.push_back(line.name);
  if (given && std::find(names.begin(), names.end(), name) == names.end())
    root.fail("base_line", fmt::format("no edge of the mesh lies on a line '{}'.{} Lines of the table 'nodes': {}",
                                       name, did_you_mean(name, names), names.empty() ? "none" : joined(names)));
  for (const auto& line : snapshot.lines) {
    if (line.name != name) continue;
    std::vector<std::int64_t> nodes = line.edges;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const std::int64_t node : nodes)
      for (std::size_t k = 0; k < 2; ++k)
        snapshot.base_velocity[k] +=
            snapshot.velocity[2 * static_cast<std::size_t>(node) + k] / static_cast<double>(nodes.size());
  }
}

// As fem.json has them.
void set_ponds(const CaseNode& root, Snapshot& snapshot) {
  std::vector<std::string> names;
  std::set<std::string> flooded;
  for (const auto& line : snapshot.lines) names.push_back(line.name);
  for (const CaseNode& node : root.list_or_empty("ponded_water")) {
    PondedLines pond{node.number("level", "m", Range::any()), node.texts_or("lines", {})};
    if (pond.lines.empty()) node.fail("lines", "at least one line of the ground under water is required");
    for (const auto& name : pond.lines)
      if (std::find(names.begin(), names.end(), name) == names.end())
        node.fail("lines", fmt::format("no edge of the mesh lies on a line '{}'.{} Lines of the table 'nodes': {}",
                                       name, did_you_mean(name, names), names.empty() ? "none" : joined(names)));
    for (const auto& name : pond.lines)
      if (!flooded.insert(name).second)
        node.fail("lines", fmt::format("line '{}' is under water twice, and would be pressed twice", name));
    snapshot.ponds.push_back(std::move(pond));
  }
}

}  // namespace

Snapshot import_tables(const CaseFile& file, Provenance& provenance) {
  const CaseNode root = file.root();
  Snapshot snapshot;
  snapshot.time = root.number_or("time", "s", Range::non_negative(), 0.0);
  snapshot.gravity = read_gravity(root, Range::positive(), 9.81);
  snapshot.fluid_density = root.number_or("fluid_density", "kg/m3", Range::positive(), 1000.0);
  check_fluid_density(root, "fluid_density", snapshot.fluid_density, snapshot.gravity);
  if (root.has("phreatic_line")) snapshot.phreatic_line = read_phreatic_line(root);
  const bool compression_positive = root.choice_or("normal_stress", {"compression_positive", "tension_positive"},
                                                   "compression_positive") == "compression_positive";

  Numbers nodes, elements;
  const auto ignored = root.texts_or("ignore_columns", {});
  read_mesh(root, ignored, snapshot, nodes, elements);
  const CaseNode region_options = root.object("regions");
  std::vector<double> density, porosity;
  for (const auto& name : snapshot.region_names) {
    const CaseNode region = region_options.object(name);
    density.push_back(region.number("density", "kg/m3", Range::positive()));
    check_voids(region);
    MaterialSetting setting;
    setting.gravity = snapshot.gravity;
    setting.water_density = snapshot.fluid_density;
    setting.has_water = !snapshot.phreatic_line.empty();
    check_material(region, setting);
    porosity.push_back(region.number_or("porosity", "1", Range::open(0.0, 1.0), 0.4));
  }
  for (const std::int32_t region : snapshot.region_id) {
    snapshot.density.push_back(density[static_cast<std::size_t>(region)]);
    snapshot.porosity.push_back(porosity[static_cast<std::size_t>(region)]);
  }

  CsvTable node_state(root.file("node_state")), element_state(root.file("element_state"));
  const auto node_rows = rows_in_order(node_state, "node", nodes);
  const auto element_rows = rows_in_order(element_state, "element", elements);
  const auto nodal = [&](const char* x, const char* y, Quantity quantity) {
    return interleaved(picked(node_state.numbers_or(x, quantity, 0.0), node_rows),
                       picked(node_state.numbers_or(y, quantity, 0.0), node_rows));
  };
  snapshot.displacement = nodal("ux", "uy", Quantity::length);
  snapshot.velocity = nodal("vx", "vy", Quantity::velocity);
  snapshot.acceleration = nodal("ax", "ay", Quantity::acceleration);
  snapshot.pore_pressure = picked(node_state.numbers("p", Quantity::pressure), node_rows);
  const double sign = compression_positive ? -1.0 : 1.0;
  snapshot.effective_stress = read_stress(element_state, element_rows, sign);
  snapshot.shear_strain = picked(element_state.numbers_or("gamma", Quantity::strain, 0.0), element_rows);
  node_state.finish(ignored);
  element_state.finish(ignored);

  require_whole_initial_state(root, snapshot.time);
  std::vector<double> initial_pressure = snapshot.pore_pressure;
  snapshot.initial_effective_stress = snapshot.effective_stress;
  if (root.has("initial_node_state")) {
    CsvTable table(root.file("initial_node_state"));
    initial_pressure = picked(table.numbers("p", Quantity::pressure), rows_in_order(table, "node", nodes));
    for (const char* name : {"ux", "uy", "vx", "vy", "ax", "ay"}) table.has(name);  // there, but of no use
    table.finish(ignored);
  }
  if (root.has("initial_element_state")) {
    CsvTable table(root.file("initial_element_state"));
    snapshot.initial_effective_stress = read_stress(table, rows_in_order(table, "element", elements), sign);
    table.has("gamma");  // there, but of no use
    table.finish(ignored);
  }
  for (std::size_t node = 0; node < snapshot.nodes(); ++node)
    snapshot.excess_pore_pressure.push_back(snapshot.pore_pressure[node] - initial_pressure[node]);
  derive_element_fields(snapshot, initial_pressure);
  set_base_velocity(root, snapshot);
  set_ponds(root, snapshot);

  file.finish();
  provenance.add_text(file.path(), file.text());
  for (const char* key :
       {"nodes", "quads", "node_state", "element_state", "initial_node_state", "initial_element_state"})
    if (root.has(key)) provenance.add_file(root.file(key));
  return snapshot;
}

}  // namespace tailrun::transfer

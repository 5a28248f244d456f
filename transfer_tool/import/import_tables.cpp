#include "transfer_tool/import/import_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "common/element_mean.hpp"
#include "common/error.hpp"
#include "transfer_tool/import/csv_table.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

constexpr double least_stress = 5e3;               // Pa, in the denominator of r_u
constexpr double least_saturation_pressure = 300;  // Pa, initial pore pressure below which a soil counts as dry

using Numbers = std::map<std::int64_t, std::size_t>;  // a table's own number to our index

Numbers numbering(const CsvTable& table, const std::string& column) {
  Numbers index;
  const auto numbers = table.integers(column);
  for (std::size_t row = 0; row < numbers.size(); ++row)
    if (!index.emplace(numbers[row], row).second) table.fail(row, column, fmt::format("{} occurs twice", numbers[row]));
  return index;
}

// Rows of a result table in the mesh's own order. Throws InputError for numbers that are missing or unknown.
std::vector<std::size_t> rows_in_order(const CsvTable& table, const std::string& column, const Numbers& mesh) {
  std::vector<std::size_t> row_of(mesh.size(), table.rows());
  const auto numbers = table.integers(column);
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    const auto it = mesh.find(numbers[row]);
    if (it == mesh.end()) table.fail(row, column, fmt::format("{} is not in the mesh", numbers[row]));
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

void read_mesh(const CaseNode& root, Snapshot& snapshot, Numbers& nodes, Numbers& elements) {
  const CsvTable node_table(root.file("nodes")), quad_table(root.file("quads"));
  snapshot.position = interleaved(node_table.numbers("x"), node_table.numbers("y"));
  nodes = numbering(node_table, "node");
  elements = numbering(quad_table, "element");
  snapshot.thickness = quad_table.numbers_or("thickness", 1.0);
  std::array<std::vector<std::int64_t>, 4> corners;
  for (std::size_t a = 0; a < 4; ++a) corners[a] = quad_table.integers(fmt::format("n{}", a + 1));
  const auto regions = quad_table.texts("region");
  for (std::size_t row = 0; row < quad_table.rows(); ++row) {
    for (std::size_t a = 0; a < 4; ++a) {
      const auto it = nodes.find(corners[a][row]);
      if (it == nodes.end())
        quad_table.fail(row, fmt::format("n{}", a + 1), fmt::format("node {} does not exist", corners[a][row]));
      snapshot.quads.push_back(static_cast<std::int64_t>(it->second));
    }
    auto& names = snapshot.region_names;
    const auto place = std::find(names.begin(), names.end(), regions[row]);
    snapshot.region_id.push_back(static_cast<std::int32_t>(place - names.begin()));
    if (place == names.end()) names.push_back(regions[row]);
    if (scaled_jacobian(initial_corners(snapshot, row)) <= 0.0)
      quad_table.fail(row, "n1", "the quadrilateral is folded or its nodes run clockwise");
  }
  if (!node_table.has("lines")) return;
  std::map<std::string, std::vector<bool>> on_line;
  const auto lines = node_table.texts("lines");
  for (std::size_t node = 0; node < lines.size(); ++node) {
    std::istringstream names(lines[node]);
    for (std::string name; std::getline(names, name, '|');)
      on_line.try_emplace(name, lines.size(), false).first->second[node] = true;
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
std::vector<double> read_stress(const CsvTable& table, const std::vector<std::size_t>& rows, double sign) {
  const auto xx = picked(table.numbers("sxx"), rows), yy = picked(table.numbers("syy"), rows);
  const auto xy = picked(table.numbers("sxy"), rows);
  const auto zz = table.has("szz") ? picked(table.numbers("szz"), rows) : std::vector<double>{};
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

void set_base_velocity(const CaseNode& root, Snapshot& snapshot) {
  const std::string name = root.text_or("base_line", "base");
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

}  // namespace

Snapshot import_tables(const CaseFile& file, Provenance& provenance) {
  const CaseNode root = file.root();
  Snapshot snapshot;
  snapshot.time = root.number_or("time", "s", Range::non_negative(), 0.0);
  snapshot.gravity = root.number_or("gravity", "m/s2", Range::positive(), 9.81);
  snapshot.fluid_density = root.number_or("fluid_density", "kg/m3", Range::positive(), 1000.0);
  if (root.has("phreatic_line")) snapshot.phreatic_line = root.table("phreatic_line", "m", 2);
  const bool compression_positive = root.choice_or("normal_stress", {"compression_positive", "tension_positive"},
                                                   "compression_positive") == "compression_positive";

  Numbers nodes, elements;
  read_mesh(root, snapshot, nodes, elements);
  const CaseNode region_options = root.object("regions");
  std::vector<double> density, porosity;
  for (const auto& name : snapshot.region_names) {
    const CaseNode region = region_options.object(name);
    density.push_back(region.number("density", "kg/m3", Range::positive()));
    porosity.push_back(region.number_or("porosity", "1", Range::open(0.0, 1.0), 0.4));
  }
  for (const std::int32_t region : snapshot.region_id) {
    snapshot.density.push_back(density[static_cast<std::size_t>(region)]);
    snapshot.porosity.push_back(porosity[static_cast<std::size_t>(region)]);
  }

  const CsvTable node_state(root.file("node_state")), element_state(root.file("element_state"));
  const auto node_rows = rows_in_order(node_state, "node", nodes);
  const auto element_rows = rows_in_order(element_state, "element", elements);
  const auto nodal = [&](const char* name) { return picked(node_state.numbers_or(name, 0.0), node_rows); };
  snapshot.displacement = interleaved(nodal("ux"), nodal("uy"));
  snapshot.velocity = interleaved(nodal("vx"), nodal("vy"));
  snapshot.acceleration = interleaved(nodal("ax"), nodal("ay"));
  snapshot.pore_pressure = picked(node_state.numbers("p"), node_rows);
  const double sign = compression_positive ? -1.0 : 1.0;
  snapshot.effective_stress = read_stress(element_state, element_rows, sign);
  snapshot.shear_strain = picked(element_state.numbers_or("gamma", 0.0), element_rows);

  std::vector<double> initial_pressure = snapshot.pore_pressure;
  snapshot.initial_effective_stress = snapshot.effective_stress;
  if (root.has("initial_node_state")) {
    const CsvTable table(root.file("initial_node_state"));
    initial_pressure = picked(table.numbers("p"), rows_in_order(table, "node", nodes));
  }
  if (root.has("initial_element_state")) {
    const CsvTable table(root.file("initial_element_state"));
    snapshot.initial_effective_stress = read_stress(table, rows_in_order(table, "element", elements), sign);
  }
  for (std::size_t node = 0; node < snapshot.nodes(); ++node)
    snapshot.excess_pore_pressure.push_back(snapshot.pore_pressure[node] - initial_pressure[node]);
  derive_element_fields(snapshot, initial_pressure);
  set_base_velocity(root, snapshot);

  file.finish();
  provenance.add_text(file.path(), file.text());
  for (const char* key :
       {"nodes", "quads", "node_state", "element_state", "initial_node_state", "initial_element_state"})
    if (root.has(key)) provenance.add_file(root.file(key));
  return snapshot;
}

}  // namespace tailrun::transfer

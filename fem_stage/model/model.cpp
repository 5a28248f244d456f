#include "fem_stage/model/model.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "common/error.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"

namespace tailrun::fem {
namespace {

void check_regions(const FemCase& options, const Mesh& mesh) {
  std::vector<std::string> described;
  for (const auto& [name, region] : options.regions) described.push_back(name);
  for (const auto& name : mesh.region_names)
    if (!options.regions.contains(name))
      throw InputError(fmt::format(
          "the mesh has a region '{}' (physical surface) that /regions of the case does not describe.{} Described: {}",
          name, did_you_mean(name, described), joined(described)));
  for (const auto& name : described)
    if (std::find(mesh.region_names.begin(), mesh.region_names.end(), name) == mesh.region_names.end())
      throw InputError(fmt::format("/regions/{}: the mesh has no such region (physical surface).{} It has: {}", name,
                                   did_you_mean(name, mesh.region_names), joined(mesh.region_names)));
}

void gather_adjacency(Model& model) {
  const std::size_t nodes = model.nodes();
  std::vector<std::vector<int>> lists(nodes);
  for (std::size_t i = 0; i < model.mesh.quads.size(); ++i)
    lists[static_cast<std::size_t>(model.mesh.quads[i])].push_back(static_cast<int>(i));
  model.adjacency_start.assign(1, 0);
  for (const auto& list : lists) {
    model.adjacency.insert(model.adjacency.end(), list.begin(), list.end());
    model.adjacency_start.push_back(static_cast<int>(model.adjacency.size()));
  }
}

std::vector<std::int64_t> nodes_of_regions(const Mesh& mesh, const std::vector<std::string>& regions) {
  std::set<std::int64_t> nodes;
  for (const auto& name : regions) {
    const auto it = std::find(mesh.region_names.begin(), mesh.region_names.end(), name);
    if (it == mesh.region_names.end())
      throw InputError(fmt::format("/boundaries/tied_column_regions: the mesh has no region '{}'.{}", name,
                                   did_you_mean(name, mesh.region_names)));
    const auto id = static_cast<std::int32_t>(it - mesh.region_names.begin());
    for (std::size_t e = 0; e < mesh.elements(); ++e)
      if (mesh.region[e] == id)
        nodes.insert(mesh.quads.begin() + static_cast<long>(4 * e), mesh.quads.begin() + static_cast<long>(4 * e + 4));
  }
  return {nodes.begin(), nodes.end()};
}

// Splits nodes of the tied columns into connected columns (left and right of the dam must not be tied to each other).
std::vector<std::vector<std::int64_t>> separate_columns(const Mesh& mesh, const std::vector<std::int64_t>& nodes) {
  const std::set<std::int64_t> inside(nodes.begin(), nodes.end());
  std::vector<std::int64_t> parent(mesh.nodes());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int64_t n) {
    while (parent[static_cast<std::size_t>(n)] != n) n = parent[static_cast<std::size_t>(n)];
    return n;
  };
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const bool all =
        std::all_of(mesh.quads.begin() + static_cast<long>(4 * e), mesh.quads.begin() + static_cast<long>(4 * e + 4),
                    [&](auto n) { return inside.contains(n); });
    if (!all) continue;
    for (int a = 1; a < 4; ++a) {
      const auto p = root(mesh.quads[4 * e]), q = root(mesh.quads[4 * e + static_cast<std::size_t>(a)]);
      parent[static_cast<std::size_t>(std::max(p, q))] = std::min(p, q);
    }
  }
  std::map<std::int64_t, std::vector<std::int64_t>> columns;
  for (const auto node : nodes) columns[root(node)].push_back(node);
  std::vector<std::vector<std::int64_t>> out;
  for (auto& [unused, column] : columns) out.push_back(std::move(column));
  return out;
}

Freedoms common_freedoms(const Model& model) {
  Freedoms freedoms(model.nodes());
  for (std::size_t n = 0; n < model.nodes(); ++n)
    if (model.pressure_fixed[n]) freedoms.fix(static_cast<std::int64_t>(n), freedom_p);
  const auto& boundaries = model.options->boundaries;
  for (const auto& line : boundaries.roller_lines)
    for (const auto node : model.mesh.nodes_of_line(line)) freedoms.fix(node, freedom_ux);
  for (const auto node : model.base_nodes) freedoms.fix(node, freedom_uy);
  const double tolerance = 1e-3 * *std::min_element(model.elements.size.begin(), model.elements.size.end());
  constexpr Freedom displacement[] = {freedom_ux, freedom_uy};
  for (const auto& column : separate_columns(model.mesh, nodes_of_regions(model.mesh, boundaries.tied_column_regions)))
    tie_equal_heights(freedoms, model.mesh, column, tolerance, displacement);
  std::set<std::int64_t> periodic;
  for (const auto& line : boundaries.periodic_lines) {
    const auto nodes = model.mesh.nodes_of_line(line);
    periodic.insert(nodes.begin(), nodes.end());
  }
  constexpr Freedom all[] = {freedom_ux, freedom_uy, freedom_p};
  const std::vector<std::int64_t> tied(periodic.begin(), periodic.end());
  tie_equal_heights(freedoms, model.mesh, tied, tolerance, all);
  return freedoms;
}

}  // namespace

Model build_model(const FemCase& options, const std::filesystem::path& mesh_file) {
  Model model;
  model.options = &options;
  model.mesh = read_gmsh(mesh_file);
  Mesh& mesh = model.mesh;
  check_regions(options, mesh);
  if (!options.phreatic_line.empty() && options.mesh.snap_to_phreatic_line > 0.0)
    spdlog::info("{} nodes moved onto the phreatic line",
                 snap_to_phreatic_line(mesh, options.phreatic_line, options.mesh.snap_to_phreatic_line));

  std::vector<int> material_of_element;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const RegionOptions& region = options.regions.at(mesh.region_names[static_cast<std::size_t>(mesh.region[e])]);
    material_of_element.push_back(region.material);
    model.thickness.push_back(region.thickness);
    const double to_mobility = 1.0 / (options.fluid_density * std::max(options.gravity, 1e-300));
    model.permeability_x.push_back(region.permeability[0] * to_mobility);
    model.permeability_y.push_back(region.permeability[1] * to_mobility);
  }
  model.elements = build_sspquadup(mesh, {}, model.thickness, options.hourglass_shape, options.pressure_points);
  const std::size_t count = model.count();
  for (auto* array : {&model.density, &model.porosity, &model.bulk_initial, &model.shear_initial, &model.stabilisation})
    array->resize(count);
  const MaterialPoints points(options.materials, material_of_element);
  points.density(model.density);
  points.porosity(model.porosity);
  points.initial_moduli(model.bulk_initial, model.shear_initial);
  for (std::size_t e = 0; e < count; ++e) {
    const double h = model.elements.size[e];
    model.stabilisation[e] =
        options.pressure_stabilisation * h * h / (model.bulk_initial[e] + 4.0 / 3.0 * model.shear_initial[e]);
  }

  gather_adjacency(model);
  model.nodal_mass.assign(model.nodes(), 0.0);
  for (std::size_t i = 0; i < mesh.quads.size(); ++i)
    model.nodal_mass[static_cast<std::size_t>(mesh.quads[i])] += model.density[i / 4] * model.elements.nodal_volume[i];
  double squares = 0.0;
  for (const double m : model.nodal_mass) squares += m * m;
  model.weight = (options.gravity > 0.0 ? options.gravity : 9.81) * std::sqrt(squares);

  model.pressure_fixed = on_or_above_phreatic_line(mesh, options.phreatic_line);
  model.base_nodes = mesh.nodes_of_line(options.boundaries.base_line);
  // The free-field columns' thickness widens the dashpots below them.
  std::map<std::array<std::int64_t, 2>, double> edge_thickness;
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = mesh.quads[4 * e + a], q = mesh.quads[4 * e + (a + 1) % 4];
      edge_thickness[{std::min(p, q), std::max(p, q)}] = model.thickness[e];
    }
  model.base_area.assign(model.base_nodes.size(), 0.0);
  for (const auto& [a, b] : mesh.lines.at(options.boundaries.base_line)) {
    const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
    const double half = 0.5 * std::hypot(mesh.x(ia) - mesh.x(ib), mesh.y(ia) - mesh.y(ib)) *
                        edge_thickness.at({std::min(a, b), std::max(a, b)});
    for (const auto node : {a, b})
      model.base_area[static_cast<std::size_t>(
          std::lower_bound(model.base_nodes.begin(), model.base_nodes.end(), node) - model.base_nodes.begin())] += half;
  }
  return model;
}

Freedoms geostatic_freedoms(const Model& model) {
  Freedoms freedoms = common_freedoms(model);
  for (const auto node : model.base_nodes) freedoms.fix(node, freedom_ux);
  for (const auto& line : model.options->boundaries.geostatic_roller_lines)
    for (const auto node : model.mesh.nodes_of_line(line)) freedoms.fix(node, freedom_ux);
  return freedoms;
}

Freedoms shaking_freedoms(const Model& model) {
  Freedoms freedoms = common_freedoms(model);
  const auto& boundaries = model.options->boundaries;
  if (boundaries.base == BaseKind::rigid)
    for (const auto node : model.base_nodes) freedoms.fix(node, freedom_ux);
  else if (boundaries.base_tied)
    for (const auto node : model.base_nodes) freedoms.tie(model.base_nodes.front(), node, freedom_ux);
  return freedoms;
}

MaterialPoints make_material_points(const Model& model) {
  std::vector<int> material_of_element;
  for (std::size_t e = 0; e < model.count(); ++e)
    material_of_element.push_back(
        model.options->regions.at(model.mesh.region_names[static_cast<std::size_t>(model.mesh.region[e])]).material);
  return MaterialPoints(model.options->materials, material_of_element);
}

std::vector<int> element_equations(const Mesh& mesh, const Freedoms::Equations& equations) {
  std::vector<int> numbers;
  numbers.reserve(3 * mesh.quads.size());
  for (const auto node : mesh.quads)
    for (std::size_t i = 0; i < 3; ++i) numbers.push_back(equations.number[3 * static_cast<std::size_t>(node) + i]);
  return numbers;
}

}  // namespace tailrun::fem

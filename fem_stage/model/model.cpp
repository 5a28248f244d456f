#include "fem_stage/model/model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/warnings.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/free_water.hpp"
#include "fem_stage/model/mesh_joints.hpp"
#include "fem_stage/model/output_places.hpp"
#include "fem_stage/model/own_weight.hpp"
#include "fem_stage/model/soft_fluid.hpp"
#include "fem_stage/model/stage_freedoms.hpp"

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

// Loads of the case and the weight of ponded water, as nodal forces.
void gather_loads(const FemCase& options, Model& model) {
  for (const auto& load : options.loads) {
    NodalLoad out;
    if (load.place.line.empty()) {
      out.forces.push_back({nodes_at(model.mesh, load.place).front(), load.traction[0], load.traction[1]});
    } else {
      const auto edges = boundary_edges(model.mesh, model.thickness, load.place.line, load.place.where);
      out.forces = line_forces(edges, load.traction, load.pressure);
    }
    out.history = load.history;
    out.in_geostatic = load.when != When::shake;
    out.in_shake = load.when != When::geostatic;
    model.loads.push_back(std::move(out));
  }
  for (const auto& pond : options.boundaries.ponds)
    for (const auto& line : pond.lines) {
      const auto edges = boundary_edges(model.mesh, model.thickness, line, pond.where);
      if (std::none_of(edges.begin(), edges.end(), [&](const BoundaryEdge& edge) {
            return std::min(model.mesh.y(static_cast<std::size_t>(edge.a)),
                            model.mesh.y(static_cast<std::size_t>(edge.b))) < pond.level;
          }))
        add_warning(fmt::format("{}: line '{}' lies above the level {:g} m, so that no water stands on it", pond.where,
                                line, pond.level));
      model.loads.push_back(
          {pond_forces(model.mesh, edges, pond.level, options.fluid_density * options.gravity), {}, true, true});
    }
}

// 2-norm of the nodal forces over thickness (N/m) of all loads at their largest.
double load_scale(const Model& model) {
  std::vector<double> force(2 * model.nodes(), 0.0);
  for (const auto& load : model.loads)
    for (const auto& f : load.forces) {
      force[2 * static_cast<std::size_t>(f.node)] += load.history.largest() * f.x;
      force[2 * static_cast<std::size_t>(f.node) + 1] += load.history.largest() * f.y;
    }
  double squares = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double f = force[i] / model.nodal_thickness[i / 2];
    squares += f * f;
  }
  return std::sqrt(squares);
}

void hold_pressure(Model& model, std::int64_t node, double value) {
  model.pressure_fixed[static_cast<std::size_t>(node)] = 1;
  model.held_pressure[static_cast<std::size_t>(node)] = value;
}

void gather_held_pressures(const FemCase& options, Model& model) {
  model.pressure_fixed = on_or_above_phreatic_line(model.mesh, options.phreatic_line);
  model.dry_at_rest.assign(model.nodes(), 0);
  if (options.above_phreatic_line.soft_fluid) {
    const bool drained = options.above_phreatic_line.surface_drained;
    const std::vector<char> surface = drained ? on_ground_surface(model.mesh) : std::vector<char>(model.nodes(), 0);
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      if (!model.pressure_fixed[n] || surface[n]) continue;
      model.pressure_fixed[n] = 0;
      model.dry_at_rest[n] = 1;
    }
  }
  model.held_pressure.assign(model.nodes(), 0.0);
  for (const auto& held : options.boundaries.held_pressure)
    for (const auto node : nodes_at(model.mesh, {held.line, {}, held.where})) {
      const auto n = static_cast<std::size_t>(node);
      hold_pressure(model, node, held.field[0] + held.field[1] * model.mesh.x(n) + held.field[2] * model.mesh.y(n));
    }
  for (const auto& pond : options.boundaries.ponds)
    for (const auto& line : pond.lines)
      for (const auto node : nodes_at(model.mesh, {line, {}, pond.where}))
        if (const double depth = pond.level - model.mesh.y(static_cast<std::size_t>(node)); depth >= 0.0)
          hold_pressure(model, node, options.fluid_density * options.gravity * depth);
}

// Nodes of the base and the area that each stands for.
void gather_base(Model& model) {
  const Mesh& mesh = model.mesh;
  model.base_nodes = nodes_at(mesh, {model.options->boundaries.base_line, {}, "/boundaries/base/line"});
  // The free-field columns' thickness widens the dashpots below them.
  std::map<std::array<std::int64_t, 2>, double> edge_thickness;
  for (std::size_t e = 0; e < model.count(); ++e)
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = mesh.quads[4 * e + a], q = mesh.quads[4 * e + (a + 1) % 4];
      edge_thickness[{std::min(p, q), std::max(p, q)}] = model.thickness[e];
    }
  model.base_area.assign(model.base_nodes.size(), 0.0);
  for (const auto& [a, b] : mesh.lines.at(model.options->boundaries.base_line)) {
    const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
    const auto thickness = edge_thickness.find({std::min(a, b), std::max(a, b)});
    if (thickness == edge_thickness.end())
      throw InputError(
          fmt::format("/boundaries/base: an edge of line '{}' at ({:.4g}, {:.4g}) is no side of an element",
                      model.options->boundaries.base_line, mesh.x(ia), mesh.y(ia)));
    const double half = 0.5 * std::hypot(mesh.x(ia) - mesh.x(ib), mesh.y(ia) - mesh.y(ib)) * thickness->second;
    for (const auto node : {a, b})
      model.base_area[static_cast<std::size_t>(
          std::lower_bound(model.base_nodes.begin(), model.base_nodes.end(), node) - model.base_nodes.begin())] += half;
  }
}

}  // namespace

Model build_model(const FemCase& options, const std::filesystem::path& mesh_file) {
  Model model;
  model.options = &options;
  model.mesh = read_gmsh(mesh_file);
  Mesh& mesh = model.mesh;
  check_regions(options, mesh);
  check_joints(mesh, options.boundaries, mesh_file.string());
  check_output_places(mesh, options);
  if (!options.phreatic_line.empty() && options.mesh.snap_to_phreatic_line > 0.0)
    log_info("{} nodes moved onto the phreatic line",
             snap_to_phreatic_line(mesh, options.phreatic_line, options.mesh.snap_to_phreatic_line));

  std::vector<int> material_of_element;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const RegionOptions& region = options.regions.at(mesh.region_names[static_cast<std::size_t>(mesh.region[e])]);
    material_of_element.push_back(region.material);
    model.thickness.push_back(region.thickness);
    // Hydraulic conductivity is defined by the weight of water on earth, whatever gravity the case has.
    const double to_mobility = 1.0 / (options.fluid_density * (options.gravity > 0.0 ? options.gravity : 9.81));
    model.permeability_x.push_back(region.permeability[0] * to_mobility);
    model.permeability_y.push_back(region.permeability[1] * to_mobility);
  }
  model.elements = build_sspquadup(mesh, {}, model.thickness, options.hourglass_shape, options.pressure_points);
  const std::size_t count = model.count();
  for (auto* array : {&model.density, &model.porosity, &model.storage, &model.bulk_initial, &model.shear_initial,
                      &model.stabilisation})
    array->resize(count);
  const MaterialPoints points(options.materials, material_of_element);
  points.density(model.density);
  points.porosity(model.porosity);
  points.initial_moduli(model.bulk_initial, model.shear_initial);
  for (std::size_t e = 0; e < count; ++e) {
    const double h = model.elements.size[e];
    model.stabilisation[e] =
        options.pressure_stabilisation * h * h / (model.bulk_initial[e] + 4.0 / 3.0 * model.shear_initial[e]);
    model.storage[e] = model.porosity[e] * (1.0 / options.fluid_bulk_modulus);
  }
  model.soft_fluid.assign(count, 0);
  if (options.above_phreatic_line.soft_fluid) fill_with_soft_fluid(model);

  gather_adjacency(model);
  model.nodal_mass.assign(model.nodes(), 0.0);
  for (std::size_t i = 0; i < mesh.quads.size(); ++i)
    model.nodal_mass[static_cast<std::size_t>(mesh.quads[i])] += model.density[i / 4] * model.elements.nodal_volume[i];
  std::vector<double> slice(model.nodes(), 0.0);  // kg/m
  for (std::size_t i = 0; i < mesh.quads.size(); ++i)
    slice[static_cast<std::size_t>(mesh.quads[i])] +=
        model.density[i / 4] * model.elements.nodal_volume[i] / model.thickness[i / 4];
  double squares = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    model.nodal_thickness.push_back(model.nodal_mass[n] / slice[n]);
    squares += slice[n] * slice[n];
  }
  model.weight = (options.gravity > 0.0 ? options.gravity : 9.81) * std::sqrt(squares);

  gather_loads(options, model);
  if (const double scale = load_scale(model); scale > 0.0)
    model.weight = options.gravity > 0.0 ? std::max(model.weight, scale) : scale;
  gather_held_pressures(options, model);
  check_pressures(model);
  warn_of_weightless_water(model);
  check_ponds_meet_line(model);
  if (options.boundaries.base != BaseKind::none) gather_base(model);
  check_support(model);
  return model;
}

std::vector<std::int64_t> nodes_at(const Mesh& mesh, const Place& place) {
  if (!place.line.empty()) {
    try {
      return mesh.nodes_of_line(place.line);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", place.where, error.what()));
    }
  }
  const std::size_t node = mesh.nearest_node(place.point[0], place.point[1]);
  const std::size_t element = mesh.nearest_element(place.point[0], place.point[1]);
  double reach = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    const auto p = static_cast<std::size_t>(mesh.quads[4 * element + a]),
               q = static_cast<std::size_t>(mesh.quads[4 * element + (a + 1) % 4]);
    reach = std::max(reach, 0.5 * std::hypot(mesh.x(p) - mesh.x(q), mesh.y(p) - mesh.y(q)));
  }
  const double distance = std::hypot(mesh.x(node) - place.point[0], mesh.y(node) - place.point[1]);
  if (distance > reach)
    throw InputError(
        fmt::format("{}: the point ({:.4g}, {:.4g}) is {:.3g} m from the nearest node ({:.4g}, {:.4g}), but at most "
                    "half an element ({:.3g} m) is allowed",
                    place.where, place.point[0], place.point[1], distance, mesh.x(node), mesh.y(node), reach));
  return {static_cast<std::int64_t>(node)};
}

MaterialPoints make_material_points(const Model& model) {
  std::vector<int> material_of_element;
  for (std::size_t e = 0; e < model.count(); ++e)
    material_of_element.push_back(
        model.options->regions.at(model.mesh.region_names[static_cast<std::size_t>(model.mesh.region[e])]).material);
  return MaterialPoints(model.options->materials, material_of_element);
}

std::vector<double> equation_thickness(const Model& model, const Freedoms::Equations& equations) {
  const auto count = static_cast<std::size_t>(equations.count);
  std::vector<double> mass(count, 0.0), slice(count, 0.0), thickness(count);
  for (std::size_t i = 0; i < equations.number.size(); ++i) {
    if (equations.number[i] < 0) continue;
    const auto equation = static_cast<std::size_t>(equations.number[i]);
    mass[equation] += model.nodal_mass[i / 3];
    slice[equation] += model.nodal_mass[i / 3] / model.nodal_thickness[i / 3];
  }
  for (std::size_t k = 0; k < count; ++k) thickness[k] = mass[k] / slice[k];
  return thickness;
}

std::vector<int> element_equations(const Mesh& mesh, const Freedoms::Equations& equations) {
  std::vector<int> numbers;
  numbers.reserve(3 * mesh.quads.size());
  for (const auto node : mesh.quads)
    for (std::size_t i = 0; i < 3; ++i) numbers.push_back(equations.number[3 * static_cast<std::size_t>(node) + i]);
  return numbers;
}

}  // namespace tailrun::fem

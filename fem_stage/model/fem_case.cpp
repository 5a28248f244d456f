#include "fem_stage/model/fem_case.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/case_file.hpp"
#include "common/error.hpp"
#include "common/plain_names.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_stiffness.hpp"
#include "common/plausible_surroundings.hpp"
#include "common/plausible_voids.hpp"
#include "fem_stage/model/doubled_entries.hpp"
#include "fem_stage/model/idle_loads.hpp"

namespace tailrun::fem {
namespace {

std::vector<std::string> keys_of(const auto& map) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

// A request that no machine carries out is refused with its numbers, before anything is computed.
constexpr double most_steps = 1e8;     // at 10 us for the smallest model: a quarter of an hour
constexpr double most_elements = 2e7;  // of a rectangle: at some 3 kB each, 60 GB

void limit_steps(const CaseNode& node, const std::string& key, double length, double step, const char* what) {
  if (!(length / step <= most_steps))
    node.fail(key,
              fmt::format("found {:g} s, which makes {:.3g} steps of the {} of {:g} s, but at most {:g} are allowed",
                          step, length / step, what, length, most_steps));
}

RectangleMesh read_rectangle(const CaseNode& node) {
  RectangleMesh out;
  const auto origin = node.numbers_or("origin", "m", Range::any(), {0.0, 0.0}, 2);
  out.origin = {origin[0], origin[1]};
  out.width = node.number("width", "m", Range::positive());
  out.columns = static_cast<int>(node.integer("columns", 1, 100000));
  if (node.has("layers")) {
    if (node.has("height") || node.has("rows") || node.has("region"))
      node.fail("layers", "give either 'layers' or 'height', 'rows' and 'region'");
    for (const auto& layer : node.list("layers"))
      out.layers.push_back({layer.text("region"), layer.number("height", "m", Range::positive()),
                            static_cast<int>(layer.integer("rows", 1, 100000))});
    if (out.layers.empty()) node.fail("layers", "an empty list; at least one layer is required");
  } else {
    out.layers.push_back({node.text("region"), node.number("height", "m", Range::positive()),
                          static_cast<int>(node.integer("rows", 1, 100000))});
  }
  out.distortion = node.number_or("distort", "1", Range::between(0.0, 0.3), 0.0);
  return out;
}

MeshOptions read_mesh(const CaseNode& node, const std::string& size) {
  MeshOptions mesh;
  if (node.has("geometry") + node.has("file") + node.has("rectangle") != 1)
    node.fail("", "give one of 'geometry' (a .geo file), 'file' (a .msh file) and 'rectangle'");
  if (node.has("geometry")) {
    mesh.geometry = node.file("geometry");
    mesh.time_limit = node.number_or("time_limit", "s", {0.0, 1e6, true, false}, mesh.time_limit);
  }
  if (node.has("file")) mesh.file = node.file("file");
  if (node.has("rectangle")) mesh.rectangle = read_rectangle(node.object("rectangle"));
  mesh.snap_to_phreatic_line = node.number_or("snap_to_phreatic_line", "m", Range::non_negative(), 0.0);
  std::map<std::string, CaseNode> sizes;
  for (const auto& [name, parameters] : node.object_or_empty("sizes").members()) {
    sizes.emplace(name, parameters);
    for (const auto& key : parameters.keys()) {
      if (mesh.rectangle && key != "refine") parameters.fail(key, "a rectangle's sizes have one parameter, 'refine'");
      const double value = mesh.rectangle ? static_cast<double>(parameters.integer(key, 1, 64))
                                          : parameters.number(key, "1", Range::any());
      if (name == size || (size.empty() && name == "default")) mesh.parameters[key] = value;
    }
  }
  require_size(node, size);
  if (sizes.empty() && !size.empty() && size != "default")
    node.fail("sizes", fmt::format("is missing, but --size {} asks for an entry of it", size));
  if (mesh.rectangle) {
    const double refine = mesh.parameters.contains("refine") ? mesh.parameters["refine"] : 1.0;
    double rows = 0.0;
    for (const auto& layer : mesh.rectangle->layers) rows += refine * layer.rows;
    const double columns = refine * mesh.rectangle->columns;
    if (columns * rows > most_elements)
      node.fail("rectangle",
                fmt::format("{:g} columns and {:g} rows make {:.3g} elements, but at most {:g} are allowed", columns,
                            rows, columns * rows, most_elements));
    mesh.rectangle->columns = static_cast<int>(columns);
    for (auto& layer : mesh.rectangle->layers) layer.rows = static_cast<int>(refine * layer.rows);
  }
  return mesh;
}

AbovePhreaticLine read_above_phreatic_line(const CaseNode& node) {
  AbovePhreaticLine out;
  out.soft_fluid = node.choice_or("water", {"drained", "soft_fluid"}, "drained") == "soft_fluid";
  if (!out.soft_fluid) return out;
  check_voids(node);
  out.saturation = node.number_or("saturation", "1", Range::between(0.0, 1.0), out.saturation);
  out.surface_drained = node.choice_or("surface", {"drained", "sealed"}, "drained") == "drained";
  return out;
}

GeostaticOptions read_geostatic(const CaseNode& node) {
  GeostaticOptions out;
  out.K0 = node.number_or("K0", "1", Range::open(0.0, 1.0), out.K0);
  out.yielding = node.choice_or("gravity", {"yielding", "elastic"}, "yielding") == "yielding";
  const std::string seepage = node.choice_or("seepage", {"isotropic", "by_region", "hydrostatic"}, "isotropic");
  out.seepage = seepage == "isotropic"   ? Seepage::isotropic
                : seepage == "by_region" ? Seepage::by_region
                                         : Seepage::hydrostatic;
  out.settle_time = node.number_or("settle_time", "s", Range::non_negative(), out.settle_time);
  out.settle_step = node.number_or("settle_step", "s", Range::positive(), out.settle_step);
  out.tolerance = node.number_or("tolerance", "1", Range::positive(), out.tolerance);
  limit_steps(node, "settle_step", out.settle_time, out.settle_step, "settling");
  return out;
}

ShakeOptions read_shake(const CaseNode& node) {
  ShakeOptions out;
  if (node.has("motion")) {
    out.motion = node.file("motion");
    out.peak_acceleration = node.number_if("peak_acceleration", "m/s2", Range::positive()).value_or(0.0);
  }
  out.duration = node.number("duration", "s", Range::positive());
  out.time_step = node.number_or("time_step", "s", Range::positive(), out.time_step);
  limit_steps(node, "time_step", out.duration, out.time_step, "shaking");
  const CaseNode newmark = node.object_or_empty("newmark");
  out.gamma = newmark.number_or("gamma", "1", Range::between(0.5, 2.0), out.gamma);
  out.beta = newmark.number_or("beta", "1", Range::between(0.25, 2.0), 0.25 * (out.gamma + 0.5) * (out.gamma + 0.5));
  out.theta = newmark.number_or("theta", "1", Range::between(0.5, 2.0), out.gamma);
  if (const auto damping = node.object_if("rayleigh_damping")) {
    out.damping_ratio = damping->number("ratio", "1", Range::between(0.0, 0.5));
    out.damping_frequency = damping->number("frequency", "Hz", Range::positive());
  }
  const CaseNode solver = node.object_or_empty("solver");
  out.tolerance = solver.number_or("tolerance", "1", Range::open(0.0, 0.1), out.tolerance);
  out.max_iterations = static_cast<int>(solver.integer_or("max_iterations", 2, 1000, out.max_iterations));
  out.max_halvings = static_cast<int>(solver.integer_or("max_halvings", 0, 20, out.max_halvings));
  out.refactor_above = static_cast<int>(solver.integer_or("refactor_above", 0, 1000, out.refactor_above));
  out.acceleration_depth = static_cast<int>(solver.integer_or("acceleration_depth", 0, 50, out.acceleration_depth));
  out.large_displacement = node.boolean_or("large_displacement", false);
  if (out.large_displacement)
    out.spin = node.choice_or("spin", {"polar", "jaumann"}, "polar") == "polar" ? Spin::polar : Spin::jaumann;
  return out;
}

ConsolidationOptions read_consolidation(const CaseNode& node) {
  ConsolidationOptions out;
  out.duration = node.number_or("duration", "s", Range::positive(), out.duration);
  out.first_step = node.number_or("first_step", "s", Range::positive(), out.first_step);
  out.largest_step = node.number_or("largest_step", "s", Range::positive(), out.largest_step);
  out.growth = node.number_or("growth", "1", Range::between(1.0, 10.0), out.growth);
  limit_steps(node, "largest_step", out.duration, out.largest_step, "consolidation");
  // Steps grow every four: their number until the largest, or, without growth, to the end.
  if (const double first = std::min(out.first_step, out.largest_step); out.growth - 1.0 < 1e-6)
    limit_steps(node, "first_step", out.duration, first, "consolidation");
  else if (4.0 * std::log(out.largest_step / first) / std::log(out.growth) > most_steps)
    node.fail("growth", fmt::format("found {:g}, with which steps of {:g} s grow too slowly to {:g} s", out.growth,
                                    first, out.largest_step));
  out.ratio_limit = node.number_or("ratio_limit", "1", Range::non_negative(), out.ratio_limit);
  out.rest_velocity = node.number_or("rest_velocity", "m/s", Range::positive(), out.rest_velocity);
  out.post_shaking = node.boolean_or("post_shaking", out.post_shaking);
  out.snapshots = node.numbers_or("snapshots", "s", Range::positive(), {});
  for (const double time : out.snapshots)
    if (time > out.duration)
      node.warn("snapshots",
                fmt::format("{:g} s: after the end of the consolidation (/consolidation/duration, {:g} s): "
                            "not written",
                            time, out.duration));
  const CaseNode solver = node.object_or_empty("solver");
  out.tolerance = solver.number_or("tolerance", "1", Range::open(0.0, 0.1), out.tolerance);
  out.max_iterations = static_cast<int>(solver.integer_or("max_iterations", 2, 1000, out.max_iterations));
  out.max_halvings = static_cast<int>(solver.integer_or("max_halvings", 0, 30, out.max_halvings));
  return out;
}

std::vector<NamedPoint> read_points(const CaseNode& node, const std::string& key) {
  std::vector<NamedPoint> points;
  const CaseNode parent = node.object_or_empty(key);
  for (const auto& name : parent.keys()) {
    require_column_name(parent, "", name, "the columns' names in history.csv");
    const auto xy = parent.numbers(name, "m", Range::any(), 2);
    points.push_back({name, xy[0], xy[1]});
  }
  return points;
}

// What is asked for far more often than there are steps comes at every step.
void warn_if_below_step(const CaseNode& node, const std::string& key, double interval, double step, const char* what) {
  if (node.has(key) && interval > 0.0 && interval < 0.1 * step)
    node.warn(key, fmt::format("{:g} s is far below the time step of {:g} s; there is {} at every step", interval, step,
                               what));
}

// Of what is only before the shaking and at its end; snapshots are judged by their plan (output/snapshot_plan.hpp).
void warn_if_beyond_end(const CaseNode& node, const std::string& key, double interval, double duration) {
  if (node.has(key) && interval > duration)
    node.warn(key,
              fmt::format("{0:g} s is longer than the shaking (/shake/duration, {1:g} s): no row comes between its "
                          "start and its end; {0:g} ms are {2:g} s",
                          interval, duration, 1e-3 * interval));
}

OutputOptions read_output(const CaseNode& node, double step, double duration) {
  OutputOptions out;
  out.snapshots = node.numbers_or("snapshots", "s", Range::non_negative(), {});
  std::sort(out.snapshots.begin(), out.snapshots.end());
  out.snapshot_interval = node.number_or("snapshot_interval", "s", Range::non_negative(), 0.0);
  out.history_interval = node.number_or("history_interval", "s", Range::positive(), out.history_interval);
  warn_if_below_step(node, "snapshot_interval", out.snapshot_interval, step, "a snapshot");
  warn_if_beyond_end(node, "history_interval", out.history_interval, duration);
  warn_if_below_step(node, "history_interval", out.history_interval, step, "a row");
  out.points = read_points(node, "points");
  out.elements = read_points(node, "elements");
  for (const auto& element : out.elements)
    for (const auto& point : out.points)
      if (element.name == point.name)
        node.fail("elements", fmt::format("'{0}' is the name of a point (/output/points), too: history.csv would have "
                                          "two columns '{0}_pore_pressure_Pa'; give it another",
                                          element.name));
  if (const auto liquefaction = node.object_if("liquefaction")) {
    out.liquefaction_region = liquefaction->text("region");
    const auto window = liquefaction->numbers("window", "m", Range::any(), 2);
    out.liquefaction_window = {window[0], window[1]};
    out.liquefaction_threshold = liquefaction->number_or("threshold", "1", Range::open(0.0, 2.0), 0.7);
  }
  return out;
}

}  // namespace

FemCase read_fem_case(const std::filesystem::path& path, const std::string& size) {
  const CaseFile file(path);
  const CaseNode root = file.root();
  FemCase out;
  root.text_or("title", "");
  out.mesh = read_mesh(root.object("mesh"), size);
  out.gravity = read_gravity(root, Range::non_negative(), out.gravity);
  const CaseNode fluid = root.object_or_empty("fluid");
  out.fluid_density = fluid.number_or("density", "kg/m3", Range::positive(), out.fluid_density);
  check_fluid_density(fluid, "density", out.fluid_density, out.gravity);
  out.fluid_bulk_modulus = fluid.number_or("bulk_modulus", "Pa", Range::positive(), out.fluid_bulk_modulus);
  check_water_stiffness(fluid, "bulk_modulus", out.fluid_bulk_modulus, out.gravity);
  if (root.has("phreatic_line")) out.phreatic_line = read_phreatic_line(root);
  out.above_phreatic_line = read_above_phreatic_line(root.object_or_empty("above_phreatic_line"));
  if (out.above_phreatic_line.soft_fluid && out.phreatic_line.empty())
    root.fail("above_phreatic_line", "the model is dry: a soft fluid needs a phreatic_line to lie above");
  const CaseNode element = root.object_or_empty("element");
  out.pressure_stabilisation =
      element.number_or("pressure_stabilisation", "1", Range::non_negative(), out.pressure_stabilisation);
  out.pressure_points = static_cast<int>(element.integer_or("pressure_quadrature", 1, 2, out.pressure_points));
  out.hourglass_shape =
      element.choice_or("hourglass_shape", {"constant_jacobian", "opensees"}, "constant_jacobian") == "opensees"
          ? HourglassShape::opensees
          : HourglassShape::constant_jacobian;
  out.hourglass_current_modulus =
      element.choice_or("hourglass_modulus", {"initial", "current"}, "initial") == "current";
  out.averaged_mass = element.choice_or("mass", {"lumped", "averaged"}, "lumped") == "averaged";
  if (out.averaged_mass && out.pressure_points == 1)
    element.fail("mass",
                 "'averaged' needs pressure_quadrature 2: the consistent part is integrated by the same points");

  std::vector<std::string> material_names;
  for (const auto& member : root.object("materials").members()) {
    const std::string& name = member.first;
    const CaseNode& node = member.second;
    material_names.push_back(name);
    check_voids(node);
    out.materials.push_back(read_material(node, name));
    MaterialSetting setting;
    setting.gravity = out.gravity;
    setting.height = 0.0;  // what compares with the weight waits for the mesh: model/own_weight.hpp
    setting.water_density = out.fluid_density;
    setting.has_water = !out.phreatic_line.empty();
    check_material(node, setting);
    const auto require_pm4 = [&](const char* key) {
      const std::string_view model = model_name(out.materials.back());
      if (model != "pm4sand" && model != "pm4silt")
        node.fail(key, fmt::format("is for soil that liquefies, model pm4sand or pm4silt; '{}' is {}", name, model));
    };
    const int index = static_cast<int>(out.materials.size()) - 1;
    if (const auto strength = node.object_if("residual_strength")) {
      require_pm4("residual_strength");
      out.residual_strength.emplace(index, read_liquefied_strength(*strength));
    }
    if (const auto softening = node.object_if("softening")) {
      require_pm4("softening");
      if (const Softening given = read_softening(*softening); given.reference_height > 0.0)
        out.softening.emplace(index, given);
    }
  }
  for (const auto& [name, node] : root.object("regions").members()) {
    RegionOptions region;
    region.material = static_cast<int>(
        std::find(material_names.begin(), material_names.end(), node.choice("material", material_names)) -
        material_names.begin());
    const auto permeability = node.numbers("permeability", "m/s", Range::non_negative());
    if (permeability.empty() || permeability.size() > 2)
      node.fail("permeability", "one value [m/s], or two (along x, along y), are required");
    check_permeability(node, "permeability", permeability, out.gravity);
    region.permeability = {permeability.front(), permeability.back()};
    region.thickness = node.number_or("thickness", "m", Range::positive(), 1.0);
    out.regions.emplace(name, region);
  }
  out.boundaries = read_boundaries(root.object("boundaries"));
  const CaseNode boundaries = root.object("boundaries");
  if (const auto base = boundaries.object_if("base")) check_dashpot_soil(*base, "rock_", out.gravity);
  for (const auto& side : boundaries.list_or_empty("free_field_dashpots")) check_dashpot_soil(side, "", out.gravity);
  out.loads = read_loads(root);
  if (!out.boundaries.ponds.empty() && out.phreatic_line.empty())
    root.fail("boundaries/ponded_water", "the model is dry: give a phreatic_line, which meets the pond at its level");
  out.geostatic = read_geostatic(root.object_or_empty("geostatic"));
  out.shake = read_shake(root.object("shake"));
  out.consolidation = read_consolidation(root.object_or_empty("consolidation"));
  out.output = read_output(root.object_or_empty("output"), out.shake.time_step, out.shake.duration);
  warn_of_doubled_loads(root, out.loads, out.shake.duration);
  refuse_doubled_dashpots(root, out.boundaries.free_field);
  refuse_two_held_pressures(root, out.boundaries.held_pressure);
  warn_of_idle_loads(root, out.loads, out.shake.duration, out.shake.time_step);
  file.finish();
  out.echo = file.echo();
  out.inputs = file.inputs();
  out.provenance.program = "fem_stage";
  out.provenance.add_text(path, file.text());
  return out;
}

}  // namespace tailrun::fem

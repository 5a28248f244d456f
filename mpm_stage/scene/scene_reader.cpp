// mpm.json from top to bottom.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_state.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/scene/request_checks.hpp"
#include "mpm_stage/scene/scene.hpp"
#include "mpm_stage/step/lone_particle.hpp"

namespace tailrun::mpm {

namespace {

void read_domain(const CaseNode& root, Scene& scene) {
  const auto node = root.object_if("domain");
  Walls<3>& walls = scene.walls;
  if (!node) return;
  const auto n = static_cast<std::size_t>(scene.dimension);
  const auto low = node->numbers("low", "m", Range::any(), n), high = node->numbers("high", "m", Range::any(), n);
  walls.bounded = true;
  for (std::size_t d = 0; d < n; ++d) {
    const double cells = (high[d] - low[d]) / scene.cell_size;
    if (!(cells > 0.0) || std::fabs(cells - std::round(cells)) > 1e-6)
      node->fail("high",
                 fmt::format("the domain is {} cells of {} m long in direction {}; it must be a whole number of cells",
                             cells, scene.cell_size, d));
    walls.low[d] = scene.origin[d] = low[d];
    walls.high[d] = high[d];
  }
  const CaseNode sides = node->object_or_empty("walls");
  const std::array<std::array<const char*, 2>, 3> names = {{{"left", "right"}, {"bottom", "top"}, {"back", "front"}}};
  for (int d = 0; d < scene.dimension; ++d)
    for (int s = 0; s < 2; ++s) {
      const auto side = sides.object_if(names[d][s]);
      if (!side) continue;
      const std::string kind = side->choice("kind", {"open", "fixed", "slip", "frictional"});
      auto& wall = walls.side[d][s];
      wall.kind = kind == "open"    ? WallKind::open
                  : kind == "fixed" ? WallKind::fixed
                  : kind == "slip"  ? WallKind::slip
                                    : WallKind::frictional;
      if (wall.kind == WallKind::frictional) wall.friction = side->number("friction", "1", Range::non_negative());
    }
  const std::string leaving = node->choice_or("leaving_particles", {"error", "remove", "wall"}, "error");
  walls.leaving = leaving == "error"    ? LeavingParticles::error
                  : leaving == "remove" ? LeavingParticles::remove
                                        : LeavingParticles::wall;
}

void read_sleep(const CaseNode& root, Scene& scene) {
  const auto node = root.object_if("sleep");
  if (!node) return;
  SleepOptions& o = scene.solver.sleep;
  o.speed = node->number("speed", "m/s", Range::non_negative());
  o.calm = node->number_or("calm", "s", Range::positive(), o.calm);
  o.nap = node->number_or("nap", "s", Range::positive(), o.nap);
  if (o.speed > 0.0 && scene.solver.transfer == TransferName::fmpm)
    root.fail("sleep", "does not go with scheme/transfer 'fmpm', whose filter needs every particle in every step");
  if (o.speed > 0.0 && scene.solver.transfer == TransferName::apic && scene.solver.local_damping == 0.0)
    root.fail("sleep", "needs scheme/transfer 'aflip' or 'flip': APIC puts momentum and forces on the nodes as one");
}

// Splines carry particles that are alone on their nodes between others; elsewhere they bear longer steps.
void warn_of_long_steps(const Scene& scene) {
  const SolverOptions& o = scene.solver;
  const double longest = longest_courant<QuadraticShape>(2);
  if (o.shape != ShapeName::quadratic || o.fields.count < 2 || o.courant <= longest) return;
  add_warning(fmt::format(
      "time/courant is {}: steps longer than {} let single particles between other soil swing ever more, until "
      "they tear the run apart",
      o.courant, longest));
}

// With linear functions and GIMP any particle at a body's side may be all but alone on a node.
double read_courant(const CaseNode& time, ShapeName shape, int dimension, double usual) {
  double longest = 1e30;
  if (shape == ShapeName::linear) longest = longest_courant<LinearShape>(dimension);
  if (shape == ShapeName::gimp) longest = longest_courant<GimpShape>(dimension);
  const double courant = time.number_or("courant", "1", {0.0, 1.5, true, false}, std::min(usual, longest));
  if (courant <= longest) return courant;
  add_warning(fmt::format(
      "time/courant is {}: with these shape functions (scheme/shape_function) particles at the side of a body "
      "bear steps up to {:.3g}, which is taken",
      courant, longest));
  return longest;
}

void read_time(const CaseNode& root, Scene& scene) {
  const CaseNode time = root.object("time");
  scene.end_time = time.number("end", "s", Range::positive());
  scene.solver.courant = read_courant(time, scene.solver.shape, scene.dimension, scene.solver.courant);
  scene.solver.maximum_step = time.number_or("maximum_step", "s", Range::positive(), 1e30);
  scene.energy_growth_limit = time.number_or("energy_growth_limit", "1", Range::positive(), scene.energy_growth_limit);
  scene.checkpoint_interval =
      time.number_or("checkpoint_interval", "min", Range::non_negative(), scene.checkpoint_interval);
  const CaseNode rest = time.object_or_empty("rest");
  scene.rest.active = rest.boolean_or("stop", true);
  scene.rest.speed = rest.number_or("speed", "m/s", Range::positive(), scene.rest.speed);
  scene.rest.duration = rest.number_or("duration", "s", Range::positive(), scene.rest.duration);
  scene.rest.energy_share = rest.number_or("energy_share", "1", {0.0, 0.1}, scene.rest.energy_share);
}

void read_output(const CaseNode& root, Scene& scene) {
  const CaseNode node = root.object_or_empty("output");
  OutputOptions& o = scene.output;
  o.frame_interval = node.number_or("frame_interval", "s", Range::non_negative(), o.frame_interval);
  o.frame_precision = node.choice_or("frame_precision", {"double", "single"}, "double") == "single" ? Precision::single
                                                                                                    : Precision::full;
  o.series_interval = node.number_or("series_interval", "s", Range::positive(), o.series_interval);
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
    o.points.push_back({point.text("name"), {x[0], x[1]}});
  }
  for (const CaseNode& section : node.list_or_empty("sections")) {
    const std::string name = section.text("name");
    const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    if (name.empty() || name.find_first_not_of(allowed) != std::string::npos)
      section.fail("name", fmt::format("'{}' becomes part of a column's name: letters, digits, _ and - only", name));
    for (const FlowSection& other : o.sections)
      if (other.name == name) section.fail("name", fmt::format("there is a section '{}' already", name));
    o.sections.push_back({name, section.number("at", "m", Range::any())});
  }
}

void read_base_motion(const CaseNode& root, Scene& scene) {
  const auto node = root.object_if("base_motion");
  if (!node) return;
  const auto path = node->file("file");
  Motion motion = read_motion(path);
  if (const auto peak = node->number_if("peak_acceleration", "m/s2", Range::positive()))
    motion = scaled_to_peak(std::move(motion), *peak);
  scene.base.start = node->number_or("start", "s", Range::non_negative(), scene.particles.transfer_time);
  warn_about_late_start(motion, scene.base.start);
  const auto direction = node->numbers_or("direction", "1", Range::any(), {1.0, 0.0}, 2);
  const double length = std::hypot(direction[0], direction[1]);
  if (!(length > 0.0)) node->fail("direction", "must not be zero");
  scene.base.direction = {direction[0] / length, direction[1] / length, 0.0};
  scene.base.motion = std::move(motion);
  scene.inputs.push_back(path);
}

template <class Column>
void keep_rows(Column& column, const std::vector<std::size_t>& rows, std::size_t count) {
  if (column.empty()) return;
  const std::size_t width = column.size() / count;
  Column kept(rows.size() * width);
  for (std::size_t r = 0; r < rows.size(); ++r)
    std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(rows[r] * width), width,
                kept.begin() + static_cast<std::ptrdiff_t>(r * width));
  column.swap(kept);
}

// Particles of rigid materials take no part: the terrain stands in their place.
void drop_rigid(Scene& scene) {
  ParticleSet& set = scene.particles;
  std::vector<std::size_t> rows;
  for (std::size_t p = 0; p < set.count(); ++p)
    if (!scene.materials[static_cast<std::size_t>(set.material_id[p])].law->rigid) rows.push_back(p);
  const std::size_t n = set.count();
  if (rows.size() == n) return;
  scene.remarks.push_back(
      fmt::format("{} of {} particles are of rigid materials and were left out", n - rows.size(), n));
  keep_rows(set.position, rows, n);
  keep_rows(set.velocity, rows, n);
  keep_rows(set.volume, rows, n);
  keep_rows(set.effective_stress, rows, n);
  keep_rows(set.pore_pressure, rows, n);
  keep_rows(set.material_id, rows, n);
  keep_rows(set.region_id, rows, n);
  keep_rows(set.source_element, rows, n);
  keep_rows(set.initial_vertical_effective_stress, rows, n);
  keep_rows(set.depth, rows, n);
  keep_rows(set.excess_pore_pressure_ratio, rows, n);
  keep_rows(set.residual_strength, rows, n);
  keep_rows(set.strength_law, rows, n);
  keep_rows(set.plastic_deviatoric_strain, rows, n);
  keep_rows(set.displacement, rows, n);
  for (auto& [name, values] : set.extra) keep_rows(values, rows, n);
  keep_rows(set.mass, rows, n);
}

// Hand-overs of earlier versions made a material of each bin of a residual strength ("liquefied_1" ...).
std::string word_on_bins(const std::string& name, const std::vector<std::string>& names) {
  const auto is_there = [&names](const std::string& n) {
    return std::find(names.begin(), names.end(), n) != names.end();
  };
  if (is_there(name + "_1"))
    return fmt::format(
        " Bins of a residual strength are no materials of their own any more: one entry '{}' takes the "
        "place of '{}_1' and the following.",
        name, name);
  const std::size_t end = name.find_last_not_of("0123456789");
  if (end != std::string::npos && end + 1 < name.size() && name[end] == '_' && is_there(name.substr(0, end)))
    return fmt::format(
        " The particles file was made by an earlier version, with a material for each bin; make the "
        "hand-over again and they are all '{}'.",
        name.substr(0, end));
  return did_you_mean(name, names);
}

// Every material name of the particles file needs an entry; entries that no particle uses are only remarked on.
std::vector<Material> order_materials(const CaseFile& file, const std::vector<Material>& given, const ParticleSet& set,
                                      Scene& scene) {
  std::vector<Material> ordered;
  std::vector<std::string> names;
  for (const auto& m : given) names.push_back(m.name);
  std::vector<bool> used(set.material_names.size(), false);
  for (const auto id : set.material_id) used[static_cast<std::size_t>(id)] = true;
  for (std::size_t k = 0; k < set.material_names.size(); ++k) {
    const auto& name = set.material_names[k];
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) {
      if (used[k])
        throw InputError(fmt::format(
            "{}: /materials has no entry '{}', which particles of the particles file are made of (it has: {}).{}",
            file.path().string(), name, joined(names), word_on_bins(name, names)));
      ordered.push_back({});
      ordered.back().name = name;
      ordered.back().law = &law_named("rigid");
      continue;
    }
    ordered.push_back(given[static_cast<std::size_t>(it - names.begin())]);
  }
  for (const auto& name : names)
    if (std::find(set.material_names.begin(), set.material_names.end(), name) == set.material_names.end())
      scene.remarks.push_back(fmt::format("material '{}' is not used by any particle", name));
  return ordered;
}

}  // namespace

namespace {

// "grid"/"cell_size", unless "sizes" has another for the size chosen: {"coarse": {"cell_size": 2}, ...}.
double read_cell_size(const CaseNode& root, const std::string& size) {
  double cell_size = root.object("grid").number("cell_size", "m", Range::between(1e-6, 1e5));
  require_size(root, size);
  for (const auto& [name, node] : root.object_or_empty("sizes").members()) {
    const double value = node.number("cell_size", "m", Range::between(1e-6, 1e5));
    if (name == size) cell_size = value;
  }
  return cell_size;
}

// Elastic bodies keep their surface, and the stress along it with it. Soil that yields keeps neither, and where it
// comes apart there is nothing to continue from.
double default_surface_share(const Scene& scene) {
  if (scene.solver.fields.several()) return 0.0;
  for (const std::int32_t id : scene.particles.material_id)
    if (!scene.materials[static_cast<std::size_t>(id)].law->keeps_surface) return 0.0;
  return 0.05;
}

}  // namespace

// What soil and state cannot be (common/plausible_*). Particles that were handed over come with the warnings of that.
void judge(const CaseNode& root, const Scene& scene) {
  const ParticleSet& set = scene.particles;
  MaterialSetting setting;
  setting.gravity = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  double low = set.position[1], high = low, wettest = 0.0;
  for (std::size_t p = 0; p < set.count(); ++p) {
    low = std::min(low, set.position[3 * p + 1]);
    high = std::max(high, set.position[3 * p + 1]);
    wettest = std::max(wettest, set.pore_pressure[p]);
  }
  setting.height = std::max(high - low, scene.cell_size);
  setting.has_water = wettest > 0.0;
  for (const auto& [name, node] : root.object("materials").members()) check_material(node, setting);
  if (scene.inputs.empty()) return;
  const bool straight_down = scene.gravity[0] == 0.0 && scene.gravity[2] == 0.0;
  check_state(columns_of(set, scene.inputs.front().string(), straight_down ? -scene.gravity[1] : 0.0));
  if (const auto note = set.notes.find("warnings"); note != set.notes.end())
    if (const auto list = json_or_null(note->second); list.is_array())
      for (const auto& text : list)
        if (text.is_string()) add_warning("from the hand-over: " + text.get<std::string>());
}

Scene read_scene(const CaseFile& file, const std::filesystem::path& particles_override, const std::string& size) {
  const CaseNode root = file.root();
  Scene scene;
  scene.title = root.text_or("title", std::filesystem::absolute(file.path()).parent_path().filename().string());
  scene.dimension = read_dimension(root);
  scene.cell_size = read_cell_size(root, size);
  const auto dimension = static_cast<std::size_t>(scene.dimension);
  std::vector<double> down(dimension, 0.0);
  down[1] = -9.81;
  const auto gravity = root.numbers_or("gravity", "m/s2", Range::any(), down, dimension);
  std::copy(gravity.begin(), gravity.end(), scene.gravity.begin());
  read_domain(root, scene);
  scene.walls.bodies = read_bodies(root, scene.dimension);
  scene.solver.surface_share = -1.0;
  read_scheme(root, scene.solver);
  read_sleep(root, scene);
  read_time(root, scene);

  const double factor = root.object_or_empty("residual_strength").number_or("factor", "1", Range::positive(), 1.0);
  check_factor(root.object_or_empty("residual_strength"), "factor", factor);
  std::vector<Material> materials;
  for (const auto& [name, node] : root.object("materials").members())
    materials.push_back(read_material(name, node, factor));

  if (root.has("particles") && particles_override.empty()) {
    generate_particles(root, materials, scene);
    scene.materials = materials;
  } else {
    const auto path = particles_override.empty() ? root.file("particles_file") : particles_override;
    if (!particles_override.empty()) root.text_or("particles_file", "");
    scene.particles = read_particles(path);
    scene.inputs.push_back(path);
    if (scene.particles.dimension != scene.dimension)
      root.fail("dimension", fmt::format("is {}, but {} holds particles of dimension {}", scene.dimension,
                                         path.string(), scene.particles.dimension));
    scene.materials = order_materials(file, materials, scene.particles, scene);
  }
  scene.terrain_lines = read_terrain(root, scene.particles);
  for (const auto& line : scene.terrain_lines) scene.terrain.add_line(line.points, line.friction, line.adhere);
  scene.solver.ponds = read_ponds(root, scene);
  scene.particles.ponds = ponds_at(scene, 0.0);
  drop_rigid(scene);
  if (scene.particles.count() == 0) root.fail("materials", "no particle is left: all materials are rigid");
  check_placement(root, scene);
  read_contact(root, scene);
  if (scene.solver.surface_share < 0.0) scene.solver.surface_share = default_surface_share(scene);
  assign_strength(file, scene);
  judge(root, scene);
  read_base_motion(root, scene);
  read_output(root, scene);
  warn_of_long_steps(scene);
  check_requests(root, scene);
  return scene;
}

}  // namespace tailrun::mpm

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
#include "mpm_stage/scene/scene_checks.hpp"
#include "mpm_stage/step/lone_particle.hpp"

namespace tailrun::mpm {

namespace {

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

void read_base_motion(const CaseNode& root, Scene& scene) {
  const auto node = root.object_if("base_motion");
  if (!node) return;
  const auto path = node->file("file");
  Motion motion = read_motion(path);
  const double recorded = motion.peak_acceleration();
  if (const auto peak = node->number_if("peak_acceleration", "m/s2", Range::positive()))
    motion = scaled_to_peak(std::move(motion), *peak);
  scene.base.start = node->number_or("start", "s", Range::non_negative(), scene.particles.transfer_time);
  // Values of the record are not left out: steps of waves in soil are far shorter than its own.
  warn_about_motion(motion, recorded, 0.0, scene.base.start + scene.end_time);
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
  if (!size.empty() && size != "default" && root.object_or_empty("sizes").keys().empty())
    root.warn("sizes",
              fmt::format("--size {} changes nothing: this case has no sizes, and cells of {:g} m", size, cell_size));
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

// What a state cannot be (common/plausible_state.hpp). Particles that were handed over come with the warnings of that.
void check_handed_over(const Scene& scene) {
  if (scene.inputs.empty()) return;
  const ParticleSet& set = scene.particles;
  const bool straight_down = scene.gravity[0] == 0.0 && scene.gravity[2] == 0.0;
  check_state(columns_of(set, scene.inputs.front().string(), straight_down ? -scene.gravity[1] : 0.0));
  if (const auto note = set.notes.find("warnings"); note != set.notes.end())
    if (const auto list = json_or_null(note->second); list.is_array())
      for (const auto& text : list)
        if (text.is_string()) add_warning("from the hand-over: " + text.get<std::string>());
}

// Particles made here or those of a file.
void read_or_make_particles(const CaseFile& file, const std::vector<Material>& materials,
                            const std::filesystem::path& given, Scene& scene) {
  const CaseNode root = file.root();
  if (root.has("particles")) {
    if (root.has("particles_file"))
      root.fail("particles_file",
                "is given beside 'particles', which fills shapes with particles: one of the two has to go");
    if (given.empty()) {
      generate_particles(root, materials, scene);
      scene.materials = materials;
      return;
    }
    root.warn("particles", fmt::format("these shapes are left out: --particles {} takes their place", given.string()));
  }
  if (given.empty() && !root.has("particles_file"))
    root.fail("", "has no particles: 'particles' (shapes to fill), 'particles_file' or --particles is required");
  const auto path = given.empty() ? root.file("particles_file") : given;
  if (!given.empty()) root.text_or("particles_file", "");
  scene.particles = read_particles(path);
  scene.inputs.push_back(path);
  if (scene.particles.dimension != scene.dimension)
    root.fail("dimension", fmt::format("is {}, but {} holds particles of dimension {}", scene.dimension, path.string(),
                                       scene.particles.dimension));
  scene.materials = order_materials(file, materials, scene.particles, scene);
}

}  // namespace

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

  read_or_make_particles(file, materials, particles_override, scene);
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
  check_gravity(root, scene);
  check_materials(root, scene);
  check_start(root, scene);
  check_bodies(root, scene);
  check_doubled_ground(root, scene);
  check_ponds(root, scene);
  check_handed_over(scene);
  read_base_motion(root, scene);
  read_output(root, scene);
  check_thresholds(root, scene);
  warn_of_long_steps(root, scene);
  check_requests(root, scene);
  return scene;
}

}  // namespace tailrun::mpm

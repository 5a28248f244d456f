// Numbers of a material that no soil has: those that fem.json knows, too (common/plausible_material.hpp), and those of
// the runout alone.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/plausible_angles.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_stiffness.hpp"
#include "mpm_stage/scene/scene_checks.hpp"

namespace tailrun::mpm {

namespace {

constexpr double largest_grain = 0.1;                         // m, that flows as a grain among grains
constexpr double lightest_grain = 30.0, light_grain = 500.0;  // kg/m3: below the first the unit is another one; pumice
constexpr double heaviest_grain = 8000.0;                     // kg/m3
constexpr double least_share_fluid = 10.0;                    // of its weight: at that its density varies by a tenth
constexpr double thinnest_band = 1e-4, widest_band = 10.0;    // m, of shear

void check_grains(const CaseNode& node, const MaterialSetting& setting) {
  if (const auto d = node.peek("grain_diameter"); d && *d > largest_grain)
    node.warn("grain_diameter", fmt::format("{:g} m is the size of boulders; {:g} mm are {:g} m", *d, *d, 1e-3 * *d));
  const auto solid = node.peek("grain_density");
  if (!solid || setting.gravity <= 0.0) return;
  if (*solid < lightest_grain)
    node.fail("grain_density", fmt::format("found {:g} kg/m3, but no grain is lighter than {:g}; {:g} g/cm3 are {:g} "
                                           "kg/m3",
                                           *solid, lightest_grain, *solid, 1e3 * *solid));
  if (*solid < light_grain || *solid > heaviest_grain)
    node.warn("grain_density", fmt::format("{:g} kg/m3: grains have 2600 to 2800, light ones {:g}, ores up to {:g}",
                                           *solid, light_grain, heaviest_grain));
  else if (const auto bulk = node.peek("density"); bulk && *bulk > *solid)
    node.warn("density", fmt::format("{:g} kg/m3 of grains and voids is more than the grains have alone "
                                     "(grain_density {:g} kg/m3)",
                                     *bulk, *solid));
}

void check_fluid(const CaseNode& node, const MaterialSetting& setting) {
  const auto bulk = node.peek("bulk_modulus");
  if (!bulk || setting.gravity <= 0.0) return;
  const double weight = node.peek("density").value_or(setting.water_density) * setting.gravity * setting.height;
  if (*bulk < least_share_fluid * weight)
    node.warn("bulk_modulus",
              fmt::format("{:g} Pa: under {:g} m of this fluid ({:.3g} Pa) its density would grow by {:.2g} %; a "
                          "hundred times the pressure is usual. Is it {:g} kPa, MPa or GPa?",
                          *bulk, setting.height, weight, 100.0 * weight / *bulk, *bulk));
}

void check_softening(const CaseNode& material, const Material& m, double cell_size) {
  const Softening& s = m.softening;
  if (!s.active) return;
  check_angles(material.object("softening"));
  const bool coheres = has_cohesion(m), cohesion_falls = coheres && s.cohesion_ratio < 1.0;
  const bool friction_falls = s.residual_friction >= 0.0 && s.residual_friction < m.friction_angle;
  if (!cohesion_falls && !friction_falls)
    material.warn(
        "softening",
        fmt::format("nothing softens: {}cohesion_ratio is {:g}{}", coheres ? "" : "the soil has no cohesion, ",
                    s.cohesion_ratio,
                    m.friction_angle > 0.0 ? " and no residual_friction_angle below friction_angle is given" : ""));
  const double length = s.reference_length;
  if (length > 0.0 && (length < thinnest_band || length > widest_band))
    material.warn(
        "softening/reference_length",
        fmt::format("{:g} m is the width of a shear band that strains belong to ({:g} to {:g} m); with it strength "
                    "falls over strains {:.3g} times those given",
                    length, thinnest_band, widest_band, length / cell_size));
}

// Strengths over sigma'_v0 in kPa.
void check_table(const CaseNode& node, const Material& m) {
  double most = 0.0;
  for (std::size_t i = 1; i < m.cohesion_table.size(); i += 2) most = std::max(most, m.cohesion_table[i]);
  check_residual_strength(node, "cohesion_table", most);
}

}  // namespace

bool has_cohesion(const Material& m) {
  return m.cohesion > 0.0 || m.cohesion_from_particles || !m.cohesion_table.empty() || m.cohesion_ratio > 0.0;
}

void check_materials(const CaseNode& root, const Scene& scene) {
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
  for (const auto& [name, node] : root.object("materials").members()) {
    const auto material = std::find_if(scene.materials.begin(), scene.materials.end(),
                                       [&name = name](const Material& m) { return m.name == name; });
    const bool in_scene = material != scene.materials.end();
    setting.flows_by_rate = in_scene && material->rate.consistency > 0.0;
    check_material(node, setting);
    check_grains(node, setting);
    check_fluid(node, setting);
    if (const auto stiffness = node.peek("pore_stiffness"))
      check_water_stiffness(node, "pore_stiffness", *stiffness, setting.gravity);
    if (!in_scene) continue;
    check_softening(node, *material, scene.cell_size);
    if (setting.gravity > 0.0) check_table(node, *material);
  }
}

}  // namespace tailrun::mpm

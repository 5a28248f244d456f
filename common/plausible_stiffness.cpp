#include "common/plausible_stiffness.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>

namespace tailrun {
namespace {

constexpr double least_strength = 100.0;                             // Pa
constexpr double least_share_strength = 1e-3;                        // of the soil's own weight
constexpr double least_share_stiffness = 0.5;                        // of the soil's own weight
constexpr double least_water_stiffness = 1e7;                        // Pa
constexpr double most_water_stiffness = 1e11;                        // Pa
constexpr double stiffest_matter = 5e11;                             // Pa
constexpr double stiffest_light = 5e10, stiffest_light_soil = 1e10;  // Pa
constexpr double light = 2300.0, light_soil = 2200.0;                // kg/m3
constexpr double largest_share_strength = 0.2;                       // of Young's modulus
constexpr double strongest_silt = 1e6;                               // Pa
constexpr double usual_density = 1800.0;                             // kg/m3, where none is given
constexpr double usual_ratio = 2.6;                                  // Young's over shear modulus at nu = 0.3

std::string parts(double value) {
  return fmt::format("is it {:g} or {:g} Pa?", 1e-3 * value, 1e-6 * value);
}

// Of the largest stiffness that something as light can have; empty when `stiffness` (Young's modulus, Pa) is below it.
std::string why_too_stiff(double stiffness, double density, bool yields) {
  if (stiffness > stiffest_matter) return "more than any matter has (steel 2e11 Pa)";
  if (density < light && stiffness > stiffest_light)
    return fmt::format("more than anything has of {:g} kg/m3 (concrete, of 2400 kg/m3, 3e10 Pa)", density);
  if (yields && density < light_soil && stiffness > stiffest_light_soil)
    return fmt::format("more than soil or rock has of {:g} kg/m3 (soils 1e6 to 1e9 Pa)", density);
  return {};
}

}  // namespace

void check_too_large(const CaseNode& node, const MaterialSetting& setting) {
  if (setting.gravity <= 0.0) return;
  const double density = node.peek("density").value_or(usual_density);
  const auto cohesion = node.peek("cohesion");
  const bool yields = cohesion || node.peek("friction_angle");
  double young = 0.0;  // Pa
  for (const char* key : {"shear_modulus", "youngs_modulus"}) {
    const auto stiffness = node.peek(key);
    if (!stiffness) continue;
    young = *stiffness * (std::string(key) == "shear_modulus" ? usual_ratio : 1.0);
    if (const std::string why = why_too_stiff(young, density, yields); !why.empty())
      node.warn(key, fmt::format("{:g} Pa is {}; {}", *stiffness, why, parts(*stiffness)));
  }
  if (const auto bulk = node.peek("bulk_modulus"); bulk && *bulk > most_water_stiffness)
    node.warn("bulk_modulus", fmt::format("{:g} Pa is far above that of water (2.2e9 Pa); {}", *bulk, parts(*bulk)));
  if (cohesion && young > 0.0 && *cohesion > largest_share_strength * young)
    node.warn("cohesion",
              fmt::format("{:g} Pa is {:.2g} of Young's modulus ({:.3g} Pa), but soils have a hundredth and less: it "
                          "would hardly yield; {} An elastic law has no strength at all",
                          *cohesion, *cohesion / young, young, parts(*cohesion)));
  if (const auto strength = node.peek("strength"); strength && *strength > strongest_silt)
    node.warn("strength", fmt::format("{:g} Pa is more than hard clay has (5e5 Pa); {}", *strength, parts(*strength)));
}

void check_against_weight(const CaseNode& node, const MaterialSetting& setting) {
  if (setting.gravity <= 0.0 || setting.height <= 0.0) return;
  const double weight = node.peek("density").value_or(usual_density) * setting.gravity * setting.height;
  // Slurry has a few pascals; frictional soil is given as few for the sake of numbers.
  const bool has_more = setting.flows_by_rate || node.peek("friction_angle").value_or(0.0) > 0.0;
  for (const char* key : {"cohesion", "strength"})
    if (const auto c = node.peek(key);
        !has_more && c && *c > 0.0 && *c < least_strength && *c < least_share_strength * weight)
      node.warn(key,
                fmt::format("{:g} Pa is a thousandth of what soils have; is it {:g} kPa = {:g} Pa?", *c, *c, 1e3 * *c));
  for (const char* key : {"shear_modulus", "youngs_modulus"})
    if (const auto stiffness = node.peek(key); stiffness && *stiffness < least_share_stiffness * weight)
      node.warn(key,
                fmt::format("{:g} Pa is less than {:.4g} m of this soil weigh ({:.3g} Pa), under which it would go "
                            "flat; is it {:g} kPa = {:g} Pa (or MPa)?",
                            *stiffness, setting.height, weight, *stiffness, 1e3 * *stiffness));
}

void check_water_stiffness(const CaseNode& node, const std::string& key, double bulk_modulus, double gravity) {
  if (gravity <= 0.0) return;
  if (bulk_modulus < least_water_stiffness)
    node.warn(key, fmt::format("{:g} Pa is far below that of water (2.2e9 Pa, with air in it down to {:g}); is it {:g} "
                               "kPa = {:g} Pa?",
                               bulk_modulus, least_water_stiffness, bulk_modulus, 1e3 * bulk_modulus));
  if (bulk_modulus > most_water_stiffness)
    node.warn(key, fmt::format("{:g} Pa is far above that of water (2.2e9 Pa); {}", bulk_modulus, parts(bulk_modulus)));
}

}  // namespace tailrun

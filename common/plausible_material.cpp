#include "common/plausible_material.hpp"

#include <fmt/core.h>

#include <numbers>

namespace tailrun {
namespace {

constexpr double lightest = 30.0;              // kg/m3: below it the number is of another unit
constexpr double heaviest = 4000.0;            // kg/m3
constexpr double least_strength = 100.0;       // Pa
constexpr double least_share_strength = 1e-3;  // of the soil's own weight
constexpr double least_share_stiffness = 0.5;  // of the soil's own weight
constexpr double least_water_stiffness = 1e7;  // Pa
constexpr double largest_radians = 1.6;        // a right angle
constexpr double largest_coefficient = 5000.0;
constexpr double largest_factor = 10.0;

void check_density(const CaseNode& node, double density, const MaterialSetting& setting) {
  if (density < lightest) {
    const std::string guess = density < 4.0 ? fmt::format("{:g} g/cm3 are {:g} kg/m3", density, 1e3 * density)
                              : density > 9.0
                                  ? fmt::format("{:g} kN/m3 are {:.4g} kg/m3", density, 1e3 * density / setting.gravity)
                                  : std::string("is it in another unit?");
    node.fail("density",
              fmt::format("found {:g} kg/m3, but no soil is lighter than {:g}; {}", density, lightest, guess));
  }
  if (setting.has_water && density < setting.water_density)
    node.warn("density", fmt::format("{:g} kg/m3 is less than water has ({:g}): below the phreatic line the soil would "
                                     "float. The density is that of soil and water together{}",
                                     density, setting.water_density,
                                     density > 60.0 && density < 200.0
                                         ? fmt::format("; {:g} lb/ft3 are {:.4g} kg/m3", density, 16.0185 * density)
                                         : ""));
  if (density > heaviest)
    node.warn("density", fmt::format("{:g} kg/m3 is more than soil or rock has (1500 to 3000)", density));
}

}  // namespace

void check_angle(const CaseNode& node, const std::string& key, double degrees) {
  if (degrees > 0.0 && degrees < largest_radians)
    node.warn(key, fmt::format("{:g} degrees; {:g} radians would be {:.3g} degrees", degrees, degrees,
                               degrees * 180.0 / std::numbers::pi));
}

void check_material(const CaseNode& node, const MaterialSetting& setting) {
  if (setting.gravity <= 0.0) return;
  const auto density = node.peek("density");
  if (density) check_density(node, *density, setting);
  const double weight = density.value_or(1800.0) * setting.gravity * setting.height;
  if (const auto c = node.peek("cohesion"); c && *c > 0.0 && *c < least_strength && *c < least_share_strength * weight)
    node.warn("cohesion",
              fmt::format("{:g} Pa is a thousandth of what soils have; is it {:g} kPa = {:g} Pa?", *c, *c, 1e3 * *c));
  for (const char* key : {"shear_modulus", "youngs_modulus"})
    if (const auto stiffness = node.peek(key); stiffness && *stiffness < least_share_stiffness * weight)
      node.warn(key, fmt::format("{:g} Pa is less than {:g} m of this soil weigh ({:.3g} Pa), under which it would go "
                                 "flat; is it {:g} kPa = {:g} Pa (or MPa)?",
                                 *stiffness, setting.height, weight, *stiffness, 1e3 * *stiffness));
  for (const char* key : {"friction_angle", "phi_cv"})
    if (const auto angle = node.peek(key)) check_angle(node, key, *angle);
  if (const auto g0 = node.peek("G0"); g0 && *g0 > largest_coefficient)
    node.warn("G0", fmt::format("{:g}; it is a coefficient without unit (100 to 2000), G = G0 p_A sqrt(p/p_A)", *g0));
}

void check_water_stiffness(const CaseNode& node, const std::string& key, double bulk_modulus, double gravity) {
  if (gravity > 0.0 && bulk_modulus < least_water_stiffness)
    node.warn(key, fmt::format("{:g} Pa is far below that of water (2.2e9 Pa, with air in it down to {:g}); is it {:g} "
                               "kPa = {:g} Pa?",
                               bulk_modulus, least_water_stiffness, bulk_modulus, 1e3 * bulk_modulus));
}

void check_factor(const CaseNode& node, const std::string& key, double factor) {
  if (factor > largest_factor)
    node.fail(key, fmt::format("found {:g}, but allowed is (0, {:g}]: strengths are multiplied by it; {:g} % are {:g}",
                               factor, largest_factor, factor, 0.01 * factor));
}

void check_residual_strength(const CaseNode& node, const std::string& key, double strength) {
  if (strength > 0.0 && strength < least_strength)
    node.warn(key,
              fmt::format("{:g} Pa is a thousandth of what liquefied soils have (1 to 50 kPa); is it {:g} kPa = {:g} "
                          "Pa?",
                          strength, strength, 1e3 * strength));
}

}  // namespace tailrun

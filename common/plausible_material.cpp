#include "common/plausible_material.hpp"

#include <fmt/core.h>

#include "common/plausible_angles.hpp"
#include "common/plausible_stiffness.hpp"
#include "common/plausible_voids.hpp"

namespace tailrun {
namespace {

constexpr double lightest = 30.0;         // kg/m3: below it the number is of another unit
constexpr double heaviest = 4000.0;       // kg/m3
constexpr double least_strength = 100.0;  // Pa
constexpr double most_residual = 1e6;     // Pa
constexpr double largest_coefficient = 5000.0;
constexpr double largest_factor = 10.0;
constexpr double least_ground_stress = 1e3;                      // Pa
constexpr double overconsolidated = 5.0;                         // S_u over sigma'_v0
constexpr double least_atmosphere = 5e4, most_atmosphere = 2e5;  // Pa
constexpr double no_cone = 1e4, softest_cone = 1e5;              // Pa, q_c1
constexpr double softest_normalised_cone = 10.0;                 // q_c1 over 0.1 MPa

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

void check_material(const CaseNode& node, const MaterialSetting& setting) {
  check_voids(node);
  if (setting.gravity <= 0.0) return;
  const auto density = node.peek("density");
  if (density) check_density(node, *density, setting);
  check_against_weight(node, setting);
  check_too_large(node, setting);
  check_angles(node);
  check_fraction(node, "strength_ratio", overconsolidated);
  if (const auto p = node.peek("atmospheric_pressure"); p && (*p < least_atmosphere || *p > most_atmosphere))
    node.warn("atmospheric_pressure",
              fmt::format("{:g} Pa is no pressure of the atmosphere (101300 Pa); is it in another unit?", *p));
  if (const auto g0 = node.peek("G0"); g0 && *g0 > largest_coefficient)
    node.warn("G0", fmt::format("{:g}; it is a coefficient without unit (100 to 2000), G = G0 p_A sqrt(p/p_A)", *g0));
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
  if (strength > most_residual)
    node.warn(key, fmt::format("{0:g} Pa is far more than liquefied soils have (1 to 50 kPa); is it {1:g} or {2:g} Pa?",
                               strength, 1e-3 * strength, 1e-6 * strength));
}

void check_fraction(const CaseNode& node, const std::string& key, double most) {
  if (const auto ratio = node.peek(key); ratio && *ratio > most)
    node.fail(key,
              fmt::format("found {0:g}, but allowed is at most {1:g}: it is a fraction of sigma'_v0; {0:g} % are {2:g}",
                          *ratio, most, 0.01 * *ratio));
}

void check_ground_stress(const CaseNode& node, const std::string& key) {
  if (const auto stress = node.peek(key); stress && *stress > 0.0 && *stress < least_ground_stress)
    node.warn(key,
              fmt::format("{0:g} Pa is the stress under less than a tenth of a metre of soil; {0:g} kPa are {1:g} Pa",
                          *stress, 1e3 * *stress));
}

void check_percentile(const CaseNode& node, const std::string& key) {
  if (const auto percent = node.peek(key); percent && *percent > 0.0 && *percent < 1.0)
    node.warn(key, fmt::format("{0:g} %, less than one in a hundred; a fraction of {0:g} is {1:g} %", *percent,
                               100.0 * *percent));
}

void check_fines_content(const CaseNode& node, const std::string& key) {
  if (const auto percent = node.peek(key); percent && *percent > 0.0 && *percent < 1.0)
    node.warn(key,
              fmt::format("{0:g} % are hardly any fines; a fraction of {0:g} is {1:g} %", *percent, 100.0 * *percent));
}

void check_cone_stress(const CaseNode& node, const std::string& key) {
  const auto cone = node.peek(key);
  if (!cone || *cone <= 0.0 || *cone >= softest_cone) return;
  const std::string found = fmt::format("{:g} Pa, but q_c1 of soil that can flow is 0.2 to 10 MPa", *cone);
  if (*cone >= no_cone) {
    node.warn(key, found);
    return;
  }
  node.fail(key, "found " + found +
                     (*cone < 100.0 ? fmt::format("; {0:g} MPa are {1:g} Pa", *cone, 1e6 * *cone)
                                    : fmt::format("; {0:g} kPa are {1:g} Pa", *cone, 1e3 * *cone)));
}

void check_normalised_cone(const CaseNode& node, const std::string& key, const char* symbol) {
  if (const auto cone = node.peek(key); cone && *cone > 0.0 && *cone < softest_normalised_cone)
    node.warn(key, fmt::format("{0} = {1:g} is less than case histories have (10 to 90); it has no unit, and is about "
                               "{2:g} for a resistance of {1:g} MPa at a stress of 0.1 MPa",
                               symbol, *cone, 10.0 * *cone));
}

}  // namespace tailrun

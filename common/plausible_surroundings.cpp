#include "common/plausible_surroundings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tailrun {
namespace {

constexpr double earth = 9.81;                                     // m/s2
constexpr double least_gravity = 9.0, most_gravity = 11.0;         // m/s2
constexpr double no_matter = 30.0;                                 // kg/m3: below it the number is of another unit
constexpr double slowest = 10.0;                                   // m/s, of waves in soil
constexpr double fastest_shear = 5e3, fastest_p = 1e4;             // m/s, of waves in the earth's crust
constexpr double heaviest_rock = 4000.0;                           // kg/m3, but for ores
constexpr double lightest_water = 900.0, heaviest_brine = 1300.0;  // kg/m3
constexpr double coarsest = 1.0, coarse = 0.1;                     // m/s, of gravel
constexpr double day = 86400.0;                                    // s
constexpr double pounds_per_cubic_foot = 16.0185;                  // kg/m3

struct GravityUnit {
  const char* name;
  double earth;  // in this unit
};
constexpr GravityUnit gravity_units[] = {
    {"g", 1.0}, {"ft/s2", 32.174}, {"in/s2", 386.1}, {"cm/s2", 981.0}, {"mm/s2", 9810.0}};

// "; 1.9 g/cm3 are 1900 kg/m3", of a density that is too small to be kg/m3.
std::string likely_density(double density, double gravity) {
  if (density < 4.0) return fmt::format("; {:g} g/cm3 are {:g} kg/m3", density, 1e3 * density);
  if (density >= 9.0) return fmt::format("; {:g} kN/m3 are {:.4g} kg/m3", density, 1e3 * density / gravity);
  return "; is it in another unit?";
}

}  // namespace

double read_gravity(const CaseNode& node, Range range, double fallback) {
  if (node.is_list("gravity"))
    node.fail("gravity", "found a list, but one number is required: the size of gravity, which pulls along -y [m/s2]");
  if (const auto given = node.peek("gravity"); given && *given < 0.0)
    node.fail("gravity", fmt::format("found {:g} m/s2, but allowed is its size, {}: gravity pulls along -y, and below "
                                     "zero it would pull upwards; is it {:g}?",
                                     *given, range.text(), -*given));
  const double gravity = node.number_or("gravity", "m/s2", range, fallback);
  check_gravity(node, "gravity", gravity);
  return gravity;
}

void check_gravity(const CaseNode& node, const std::string& key, double gravity) {
  if (gravity == 0.0 || (gravity >= least_gravity && gravity <= most_gravity)) return;
  for (const auto& unit : gravity_units)
    if (std::abs(gravity / unit.earth - 1.0) < 0.03) {
      node.warn(
          key, fmt::format("{0:g} m/s2; {0:g} {1} are {2:.4g} m/s2", gravity, unit.name, gravity * earth / unit.earth));
      return;
    }
  node.warn(key, fmt::format("{:g} m/s2 is {:.3g} times that of the earth ({:g}); is the unit right?", gravity,
                             gravity / earth, earth));
}

void check_fluid_density(const CaseNode& node, const std::string& key, double density, double gravity) {
  if (gravity <= 0.0) return;
  if (density < no_matter)
    node.fail(key,
              fmt::format("found {:g} kg/m3, but water has 1000 kg/m3{}", density, likely_density(density, earth)));
  if (density < lightest_water || density > heaviest_brine)
    node.warn(key, fmt::format("{:g} kg/m3 is no density of water (1000, brine up to 1200){}", density,
                               density > 55.0 && density < 80.0 ? fmt::format("; {:g} lb/ft3 are {:.4g} kg/m3", density,
                                                                              pounds_per_cubic_foot * density)
                                                                : ""));
}

void check_permeability(const CaseNode& node, const std::string& key, const std::vector<double>& permeability,
                        double gravity) {
  if (gravity <= 0.0 || permeability.empty()) return;
  const double most = *std::max_element(permeability.begin(), permeability.end());
  if (most > coarsest)
    node.fail(key, fmt::format("found {0:g} m/s, but no soil lets water through faster than {1:g} m/s (clean gravel); "
                               "{0:g} cm/s are {2:.3g} m/s, {0:g} m/day are {3:.3g} m/s",
                               most, coarsest, 0.01 * most, most / day));
  if (most > coarse)
    node.warn(key, fmt::format("{0:g} m/s is what clean gravel has (0.01 to 1), sand has 1e-5 to 1e-2; {0:g} cm/s are "
                               "{1:.3g} m/s, {0:g} m/day are {2:.3g} m/s",
                               most, 0.01 * most, most / day));
}

void check_dashpot_soil(const CaseNode& node, const std::string& prefix, double gravity) {
  if (gravity <= 0.0) return;
  const std::string key = prefix + "density";
  if (const auto density = node.peek(key); density && *density > 0.0 && *density < no_matter)
    node.fail(key, fmt::format("found {:g} kg/m3, but no soil or rock is lighter than {:g}{}", *density, no_matter,
                               likely_density(*density, earth)));
  for (const char* wave : {"shear_velocity", "p_velocity"})
    if (const auto speed = node.peek(prefix + wave); speed && *speed > 0.0 && *speed < slowest)
      node.warn(prefix + wave,
                fmt::format("{0:g} m/s is slower than waves are in any soil (50 to 400 m/s; rock 700 and "
                            "more); {0:g} km/s are {1:g} m/s",
                            *speed, 1e3 * *speed));
  if (const auto density = node.peek(key); density && *density > heaviest_rock)
    node.warn(key, fmt::format("{0:g} kg/m3 is more than rock has (2000 to 3300): the base takes in less of the waves; "
                               "{0:g} g/m3 are {1:g} kg/m3",
                               *density, 1e-3 * *density));
  const auto shear = node.peek(prefix + "shear_velocity"), p = node.peek(prefix + "p_velocity");
  for (const auto& [wave, speed, fastest] :
       {std::tuple{"shear_velocity", shear, fastest_shear}, std::tuple{"p_velocity", p, fastest_p}})
    if (speed && *speed > fastest)
      node.warn(prefix + wave, fmt::format("{0:g} m/s is faster than such waves are in any rock ({1:g} m/s): the base "
                                           "is all but rigid; {0:g} mm/s are {2:g} m/s",
                                           *speed, fastest, 1e-3 * *speed));
  // No elastic body has less than sqrt(4 / 3), where its volume gives way freely.
  if (shear && p && *p > 0.0 && *p < 1.15 * *shear)
    node.warn(prefix + "p_velocity", fmt::format("{:g} m/s is not faster than the shear waves ({}shear_velocity {:g} "
                                                 "m/s), as it is in all matter by 1.15 at least; are they exchanged?",
                                                 *p, prefix, *shear));
}

std::vector<double> read_phreatic_line(const CaseNode& node) {
  std::vector<double> line = node.table("phreatic_line", "m", 2);
  for (std::size_t i = 2; i + 1 < line.size(); i += 2)
    if (line[i] <= line[i - 2])
      node.fail("phreatic_line", fmt::format("row {}: found x = {:g} m after {:g} m, but x must ascend from row to row",
                                             i / 2, line[i], line[i - 2]));
  return line;
}

}  // namespace tailrun

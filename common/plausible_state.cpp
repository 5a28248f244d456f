#include "common/plausible_state.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "common/error.hpp"
#include "common/warnings.hpp"

namespace tailrun {
namespace {

constexpr double lightest = 30.0;          // kg/m3
constexpr double share_in_tension = 0.01;  // from here on a warning
constexpr double share_off = 0.1;          // of densities and r_u
constexpr double half = 0.5;
constexpr std::array<double, 2> ratio_range = {-0.5, 1.2};  // of r_u
constexpr double doubtful_factor = 2.0, impossible_factor = 10.0;
constexpr double saturated_above = 300.0;  // Pa
constexpr double least_sum = 1.0;          // Pa, below which there is no weight to compare with

// Those for which `is_off` holds: how many, and the worst of them by `badness`.
struct Found {
  std::size_t count = 0, of = 0, worst = 0;
  double low = 0.0, high = 0.0;
  double share() const { return of ? static_cast<double>(count) / static_cast<double>(of) : 0.0; }
};

Found find(const std::vector<double>& values, const std::function<bool(std::size_t)>& asked,
           const std::function<double(double)>& badness) {
  Found found;
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!asked(i)) continue;
    ++found.of;
    const double bad = badness(values[i]);
    if (bad <= 0.0) continue;
    if (found.count == 0) found.low = found.high = values[i];
    found.low = std::min(found.low, values[i]);
    found.high = std::max(found.high, values[i]);
    ++found.count;
    if (bad <= worst) continue;
    worst = bad;
    found.worst = i;
  }
  return found;
}

std::string where(const StateColumns& s, const Found& found, double scale, const char* unit) {
  return fmt::format("{} of {} {}, {:.4g} to {:.4g}{}, worst at ({:.4g}, {:.4g}) m", found.count, found.of, s.what,
                     scale * found.low, scale * found.high, unit, s.x[found.worst], s.y[found.worst]);
}

// What unit a stress is likely in that is `ratio` times what it should be in Pa.
std::string likely_unit(double ratio) {
  static const std::vector<std::pair<double, std::string>> units = {{1e-3, "kPa were taken for Pa"},
                                                                    {1e-6, "MPa were taken for Pa"},
                                                                    {1.0 / 47.88, "psf were taken for Pa"},
                                                                    {1.0 / 6894.8, "psi were taken for Pa"},
                                                                    {1.0 / 47880.0, "ksf were taken for Pa"},
                                                                    {1e-5, "bar were taken for Pa"},
                                                                    {1.0 / 9806.65, "t/m2 were taken for Pa"},
                                                                    {1.0 / 98066.5, "kgf/cm2 were taken for Pa"},
                                                                    {1e3, "Pa were taken for kPa"},
                                                                    {1e6, "Pa were taken for MPa"}};
  std::string best;
  double least = 0.35;  // of a natural logarithm: 1.4 times either way
  for (const auto& [factor, words] : units)
    if (const double off = std::abs(std::log(ratio / factor)); off < least) {
      least = off;
      best = words;
    }
  return best.empty() ? std::string("is the unit right?") : "most likely " + best;
}

void check_density(const StateColumns& s) {
  const auto all = [](std::size_t) { return true; };
  const Found light = find(s.density, all, [](double d) { return lightest - d; });
  if (light.count > 0)
    throw InputError(fmt::format("{}: density: no soil is lighter than {:g} kg/m3: {}; {}", s.file, lightest,
                                 where(s, light, 1.0, " kg/m3"),
                                 light.high < 4.0 ? "most likely g/cm3 (1.9 g/cm3 are 1900 kg/m3)"
                                                  : "most likely kN/m3 (19 kN/m3 are 1937 kg/m3)"));
  const auto wet = [&](std::size_t i) { return !s.pore_pressure.empty() && s.pore_pressure[i] > saturated_above; };
  const Found floats = find(s.density, wet, [&](double d) { return s.water_density - d; });
  if (floats.share() > share_off)
    add_warning(fmt::format("{}: density: soil with water in it is heavier than water ({:g} kg/m3): {}", s.file,
                            s.water_density, where(s, floats, 1.0, " kg/m3")));
}

void check_tension(const StateColumns& s) {
  const auto all = [](std::size_t) { return true; };
  const Found tension = find(s.vertical_effective, all, [](double v) { return v <= 0.0 ? 1.0 - v : 0.0; });
  if (tension.share() <= share_in_tension) return;
  const std::string words =
      fmt::format("{}: sigma'_v0, the vertical effective stress before shaking, is not a compression in {}", s.file,
                  where(s, tension, 1e-3, " kPa"));
  if (tension.share() > half)
    throw InputError(
        words +
        "; most likely the sign of the stresses (tension positive or compression positive), or water whose "
        "weight is not on the ground: below the phreatic line soil and water together weigh more than water");
  add_warning(words);
}

void check_weight(const StateColumns& s) {
  double stress = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < s.weight_above.size(); ++i) {
    stress += s.total_vertical[i];
    weight += s.weight_above[i];
  }
  if (weight / static_cast<double>(std::max<std::size_t>(s.weight_above.size(), 1)) < least_sum) return;
  const double ratio = stress / weight;
  const std::string words = fmt::format(
      "{}: the total vertical stress is {:.3g} times the weight of soil and water above, on the mean of {} {}", s.file,
      ratio, s.weight_above.size(), s.what);
  if (ratio <= 0.0) throw InputError(words + "; most likely the sign of the stresses or of the pore pressures");
  if (ratio > impossible_factor || ratio < 1.0 / impossible_factor)
    throw InputError(fmt::format("{}; {}", words, likely_unit(ratio)));
  if (ratio > doubtful_factor || ratio < 1.0 / doubtful_factor)
    add_warning(fmt::format("{}; are its units and signs right?", words));
}

void check_effective(const StateColumns& s) {
  if (!s.before_motion || s.weight_above.size() != s.vertical_effective.size()) return;
  constexpr double least_share = 0.2, least = 0.5, most = 1.7;
  double effective = 0.0, left = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < s.weight_above.size(); ++i) {
    effective += s.vertical_effective[i];
    left += s.weight_above[i] - s.pore_pressure[i];
    weight += s.weight_above[i];
  }
  if (weight / static_cast<double>(std::max<std::size_t>(s.weight_above.size(), 1)) < least_sum ||
      left < least_share * weight)
    return;
  const double ratio = effective / left;
  const std::string words = fmt::format(
      "{}: sigma'_v0 is {:.3g} times what the weight of soil and water above leaves beside the pore pressure, on the "
      "mean of {} {}",
      s.file, ratio, s.weight_above.size(), s.what);
  if (ratio > 0.0 && ratio < 1.0 / impossible_factor)
    throw InputError(fmt::format("{}; {}", words, likely_unit(ratio)));
  if (ratio < least || ratio > most)
    add_warning(fmt::format("{}; are these effective stresses{}?", words,
                            ratio > most ? ", not total ones" : ", in the unit of the pore pressures"));
}

void check_pressure(const StateColumns& s) {
  double pressure = 0.0, at_rest = 0.0;
  for (std::size_t i = 0; i < s.hydrostatic.size(); ++i)
    if (s.hydrostatic[i] > 0.0) {
      pressure += s.pore_pressure[i];
      at_rest += s.hydrostatic[i];
    }
  if (at_rest <= 0.0) return;
  const double ratio = pressure / at_rest;
  if (ratio < 0.0)
    add_warning(
        fmt::format("{}: the initial pore pressure below the phreatic line is a suction ({:.3g} times that of "
                    "water at rest); most likely its sign (compression is positive)",
                    s.file, ratio));
  else if (ratio != 0.0 && ratio < 0.01)
    add_warning(
        fmt::format("{}: the initial pore pressure below the phreatic line is {:.3g} times that of water at rest; {}",
                    s.file, ratio, likely_unit(ratio)));
}

void check_ratio(const StateColumns& s) {
  const auto all = [](std::size_t) { return true; };
  const Found off =
      find(s.pressure_ratio, all, [](double r) { return std::max(ratio_range[0] - r, r - ratio_range[1]); });
  if (off.share() > share_off)
    add_warning(
        fmt::format("{}: r_u is outside of [{:g}, {:g}] in {}; are the sign and the unit of the pore pressures right?",
                    s.file, ratio_range[0], ratio_range[1], where(s, off, 1.0, "")));
}

double elevation(const std::vector<double>& line, double x) {
  if (x <= line[0]) return line[1];
  for (std::size_t i = 2; i + 1 < line.size(); i += 2)
    if (x <= line[i]) return line[i - 1] + (line[i + 1] - line[i - 1]) * (x - line[i - 2]) / (line[i] - line[i - 2]);
  return line[line.size() - 1];
}

}  // namespace

void check_state(const StateColumns& state) {
  check_density(state);
  check_tension(state);
  check_weight(state);
  check_effective(state);
  check_pressure(state);
  check_ratio(state);
}

StateColumns columns_of(const Snapshot& snapshot, const std::string& file, const std::vector<bool>& kept,
                        bool weights) {
  StateColumns s;
  s.file = file;
  s.what = "elements";
  s.before_motion = true;
  s.water_density = snapshot.fluid_density;
  if (snapshot.gravity <= 0.0) return s;
  const bool wet = snapshot.phreatic_line.size() >= 2;
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    if (!kept.empty() && !kept[e]) continue;
    double x = 0.0, y = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(snapshot.quads[4 * e + a]);
      x += 0.25 * snapshot.position[2 * node];
      y += 0.25 * snapshot.position[2 * node + 1];
    }
    s.x.push_back(x);
    s.y.push_back(y);
    s.vertical_effective.push_back(snapshot.initial_vertical_effective_stress[e]);
    s.pressure_ratio.push_back(snapshot.excess_pore_pressure_ratio[e]);
    s.density.push_back(snapshot.density[e]);
    s.pore_pressure.push_back(snapshot.initial_pore_pressure[e]);
    if (!weights) continue;
    const double unit_weight = snapshot.fluid_density * snapshot.gravity;
    const double water = wet ? elevation(snapshot.phreatic_line, x) : y;
    s.total_vertical.push_back(snapshot.initial_vertical_effective_stress[e] + snapshot.initial_pore_pressure[e]);
    s.weight_above.push_back(snapshot.density[e] * snapshot.gravity * snapshot.depth[e] +
                             unit_weight * std::max(0.0, water - (y + snapshot.depth[e])));
    if (wet) s.hydrostatic.push_back(unit_weight * std::max(0.0, water - y));
  }
  return s;
}

StateColumns columns_of(const ParticleSet& particles, const std::string& file, double gravity) {
  StateColumns s;
  s.file = file;
  s.what = "particles";
  if (gravity <= 0.0) return s;
  const std::size_t n = particles.count();
  double volume = 0.0;
  for (std::size_t p = 0; p < n; ++p) {
    s.x.push_back(particles.position[3 * p]);
    s.y.push_back(particles.position[3 * p + 1]);
    s.density.push_back(particles.mass[p] / particles.volume[p]);
    volume += particles.volume[p];
  }
  s.vertical_effective = particles.initial_vertical_effective_stress;
  s.pressure_ratio = particles.excess_pore_pressure_ratio;
  s.pore_pressure = particles.pore_pressure;
  const auto k = static_cast<std::size_t>(particles.components());
  const bool stressed = std::any_of(particles.effective_stress.begin(), particles.effective_stress.end(),
                                    [](double v) { return v != 0.0; });
  if (particles.dimension != 2 || !stressed) return s;
  // Columns two particles wide; what lies higher in the same column weighs on a particle, and half of itself.
  const double width = 2.0 * std::sqrt(volume / static_cast<double>(n));
  std::map<long, std::vector<std::size_t>> columns;
  for (std::size_t p = 0; p < n; ++p)
    if (std::abs(s.x[p] / width) < 1e15) columns[std::lround(std::floor(s.x[p] / width))].push_back(p);
  s.total_vertical.assign(n, 0.0);
  s.weight_above.assign(n, 0.0);
  for (auto& [index, column] : columns) {
    std::sort(column.begin(), column.end(), [&](std::size_t a, std::size_t b) { return s.y[a] > s.y[b]; });
    // Ponds weigh on the top.
    double above = 0.0;
    for (const auto& pond : particles.ponds)
      if (const double x = s.x[column.front()];
          (pond.endless[0] || x >= pond.extent[0]) && (pond.endless[1] || x <= pond.extent[1]))
        above += pond.density * gravity * std::max(0.0, pond.level - s.y[column.front()] - 0.25 * width);
    for (const std::size_t p : column) {
      const double own = particles.mass[p] * gravity / width;
      s.weight_above[p] = above + 0.5 * own;
      s.total_vertical[p] = particles.pore_pressure[p] - particles.effective_stress[k * p + 1];
      above += own;
    }
  }
  return s;
}

}  // namespace tailrun

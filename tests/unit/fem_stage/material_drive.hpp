// Driving PM4 points directly, and reading the reference tables.
#pragma once

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "fem_stage/element_test/element_test_case.hpp"
#include "fem_stage/material/pm4_point.hpp"
#include "fem_stage/material/pm4sand.hpp"
#include "fem_stage/material/pm4silt.hpp"

namespace tailrun::fem::testing {

inline Pm4SandParameters sand(double relative_density, double G0, double hpo, double Q = 10.0, double R = 1.5) {
  Pm4SandParameters p;
  p.relative_density = relative_density;
  p.shear_coefficient = G0;
  p.contraction_rate = hpo;
  p.Q = Q;
  p.R = R;
  p.density = 1870.0;
  return p;
}
inline Pm4SandParameters tailings() {
  return sand(0.35, 476.0, 2.70, 11.998, 3.75);
}
inline Pm4SandParameters loose() {
  return sand(0.35, 476.0, 0.53);
}
inline Pm4SandParameters embankment() {
  return sand(0.55, 677.0, 0.40);
}
inline Pm4SandParameters foundation() {
  return sand(0.75, 890.0, 0.63);
}
inline Pm4SandParameters named(const std::string& name) {
  if (name == "tailings") return tailings();
  if (name == "loose") return loose();
  return name == "embankment" ? embankment() : foundation();
}
template <class Parameters>
Parameters as_opensees(Parameters p) {
  p.compatibility = Pm4Compatibility::opensees;
  return p;
}

template <class Law>
struct PointDrive {
  Law law;
  Pm4PointConstants constants;
  Pm4State state, trial;
  Pm4AdaptiveOptions options;
  long substeps = 0;

  // Starts at (s_xx, s_yy, s_xy), compression positive, Pa.
  PointDrive(const Law& resolved, double xx, double yy, double xy = 0.0) : law(resolved) {
    initialise(law, PlaneStress{0.5 * (xx + yy), {0.5 * (xx - yy), xy}}, true, constants, state);
  }
  // Compression-positive normal strains, engineering shear strain.
  long step(double e_xx, double e_yy, double gamma) {
    const PlaneStrain strain{e_xx + e_yy, {0.5 * (e_xx - e_yy), 0.5 * gamma}};
    const long done = trial_update(law, constants, options, state, strain, trial);
    substeps += done;
    commit_update(law, constants, state, trial);
    return done;
  }
  double xx() const { return state.v.p + state.v.s.d; }
  double yy() const { return state.v.p - state.v.s.d; }
  double xy() const { return state.v.s.xy; }
  double f() const { return yield_function(law.m, state.v.p, state.v.s, state.v.alpha); }
};
inline PointDrive<Pm4SandLaw> drive(const Pm4SandParameters& p, double xx, double yy, double xy = 0.0) {
  return {resolve(p), xx, yy, xy};
}
inline PointDrive<Pm4SiltLaw> drive(const Pm4SiltParameters& p, double xx, double yy, double xy = 0.0) {
  return {resolve(p), xx, yy, xy};
}

struct CycleCounts {
  double to_1_percent = -1.0;
  double to_3_percent = -1.0;
};
// Reversal counts (0.25, 0.75, ...) last passed when |gamma| first exceeds 1 % and 3 %; constant volume, strain steps
// of d_gamma, reversed once the shear stress has reached (bias +- csr) vertical stress.
template <class Drive>
CycleCounts count_cycles(Drive point, double csr, double vertical, double d_gamma, double bias = 0.0) {
  CycleCounts counts;
  double direction = 1.0, gamma = 0.0;
  int reversals = 0;
  while (counts.to_3_percent < 0.0 && reversals < 400) {
    gamma += direction * d_gamma;
    point.step(0.0, 0.0, direction * d_gamma);
    if (direction * (point.xy() - bias * vertical) >= csr * vertical) {
      direction = -direction;
      ++reversals;
    }
    const double passed = reversals > 0 ? 0.5 * reversals - 0.25 : 0.0;
    if (counts.to_1_percent < 0.0 && std::fabs(gamma) > 0.01) counts.to_1_percent = passed;
    if (std::fabs(gamma) > 0.03) counts.to_3_percent = passed;
  }
  return counts;
}

struct Table {
  std::map<std::string, std::vector<double>> columns;
  std::size_t rows = 0;
  const std::vector<double>& operator[](const std::string& name) const { return columns.at(name); }
};
// CSV with a header; words become NaN.
inline Table read_table(const std::string& name) {
  std::ifstream file(std::string(TAILRUN_TEST_DATA) + "/opensees/" + name);
  Table table;
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line);) {
    std::stringstream fields(line);
    std::size_t k = 0;
    for (std::string field; std::getline(fields, field, ','); ++k) {
      if (names.size() <= k && table.rows == 0 && table.columns.size() <= k) {
        names.push_back(field);
        table.columns[field];
        continue;
      }
      char* end = nullptr;
      const double value = std::strtod(field.c_str(), &end);
      table.columns[names[k]].push_back(end == field.c_str() ? std::nan("") : value);
    }
    if (!table.columns.empty()) table.rows = table.columns[names[0]].size();
  }
  return table;
}

// Linear interpolation in a growing x.
inline double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  std::size_t i = 1;
  while (i + 1 < x.size() && x[i] < at) ++i;
  const double share = x[i] > x[i - 1] ? (at - x[i - 1]) / (x[i] - x[i - 1]) : 0.0;
  return y[i - 1] + std::min(1.0, std::max(0.0, share)) * (y[i] - y[i - 1]);
}

inline std::vector<double> column(const ElementTestResult& result, double ElementTestRow::*member) {
  std::vector<double> out;
  for (const ElementTestRow& row : result.rows) out.push_back(row.*member);
  return out;
}

}  // namespace tailrun::fem::testing

// What soil lies in: gravity, pore water, the phreatic line, how fast water gets through, the rock around. Numbers that
// are no such thing, most often because their unit is another one, are said here for every case file that has them: an
// error where nothing sensible can follow, else a warning (common/warnings.hpp).
#pragma once

#include <string>
#include <vector>

#include "common/case_file.hpp"

namespace tailrun {

// "gravity" of a case whose gravity pulls along -y, m/s2: its size. A list (a vector is what mpm.json has) and a number
// below zero (which would pull upwards) are errors that say so; then as check_gravity.
double read_gravity(const CaseNode& node, Range range, double fallback);

// m/s2, its size, with reasons:
//   0            allowed: loads and motion alone
//   9 to 11      earth, and 10 as many take it
//   else         a warning with the unit that fits (g, ft/s2, cm/s2, mm/s2); a model in a centrifuge has more, so it is
//                no error
void check_gravity(const CaseNode& node, const std::string& key, double gravity);

// kg/m3, of pore water and ponds. Nothing without gravity, where densities weigh nothing.
//   under 30     g/cm3 or kN/m3 (error): hydraulic heads and effective stresses would be a hundred times off
//   under 900, over 1300
//                no water, and no brine (saturated: 1200) has it: warning, with lb/ft3 where that fits
void check_fluid_density(const CaseNode& node, const std::string& key, double density, double gravity);

// m/s, hydraulic conductivity; 0 is sealed. Clean gravel has 0.01 to 1.
//   over 1       no soil has it (error): m/day or cm/s were taken for m/s
//   over 0.1     warning
void check_permeability(const CaseNode& node, const std::string& key, const std::vector<double>& permeability,
                        double gravity);

// Rock (or soil) beyond the model's edge, whose density and wave speeds make the dashpots there; keys as they are
// there:
//   density       under 30: g/cm3 or kN/m3 (error), since the dashpot would be none; over 4000, which rock has not: in
//                 g/m3 or another unit (warning)
//   shear_velocity, p_velocity
//                 above 0 and under 10 m/s: km/s (warning); over 5000 and 10000 m/s, which no rock of the crust has:
//                 mm/s, or a base that is all but rigid (warning)
//   p_velocity    under 1.15 times shear_velocity, less than any elastic body has (warning)
// each with `prefix` before it ("rock_density"). Nothing without gravity.
void check_dashpot_soil(const CaseNode& node, const std::string& prefix, double gravity);

// "phreatic_line": [[x, y], ...] m. Its x ascend from row to row (error): elevations between rows are found by x.
std::vector<double> read_phreatic_line(const CaseNode& node);

}  // namespace tailrun

// A column of sand that collapses onto the end of a long bed of the same sand, most of which it never reaches: what
// sleeping blocks save, and what they change.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "mpm_stage/step/solver.hpp"

namespace tailrun::bench {

// How such a run ended, 5 s after the column was let go.
struct QuietBedOutcome {
  double front = 0.0;       // m, in front of which 0.1 % of the column lies
  double moved_mass = 0.0;  // kg per metre, of what has moved by more than a cell
  double particle_steps = 0.0, share_asleep = 0.0;
};

inline QuietBedOutcome run_quiet_bed(const mpm::SleepOptions& sleep) {
  constexpr double cell = 0.125, spacing = 0.5 * cell, density = 1700.0, depth = 1.0, end = 5.0;
  constexpr int bed_columns = 640, bed_rows = 16, columns = 32, rows = 64;  // 40 x 1 m, 2 x 4 m
  constexpr double stress_ratio = 0.5;                                      // of the bed, horizontal over vertical
  mpm::Particles<2> P;
  P.resize(bed_columns * bed_rows + columns * rows, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const bool bed = p < bed_columns * bed_rows;
    const std::size_t k = bed ? p : p - bed_columns * bed_rows, width = bed ? bed_columns : columns;
    P.position[0][p] = (static_cast<double>(k % width) + 0.5) * spacing;
    P.position[1][p] = (static_cast<double>(k / width) + 0.5) * spacing + (bed ? 0.0 : depth);
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
    if (!bed) continue;
    P.stress[1][p] = -density * 9.81 * (depth - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = stress_ratio * P.stress[1][p];
  }
  const mpm::Particles<2> start = P;

  mpm::Material sand;
  sand.name = "sand";
  sand.law = &mpm::law_named("mohr_coulomb");
  sand.youngs_modulus = 2e6;
  sand.poisson_ratio = 0.3;
  sand.friction_angle = 30.0;
  mpm::Walls<2> walls;
  walls.bounded = true;
  walls.low = {0.0, -1.0};
  walls.high = {bed_columns * spacing, 8.0};
  for (auto& side : walls.side[0]) side.kind = mpm::WallKind::slip;
  mpm::Terrain floor;
  floor.add_line({{{-10.0, 0.0}}, {{100.0, 0.0}}}, {0.6}, false);
  mpm::SolverOptions options;
  options.sleep = sleep;
  auto solver = mpm::make_solver<2>(options, cell, {}, std::move(P), {sand}, floor, walls);
  solver->start(end);

  QuietBedOutcome out;
  double asleep = 0.0;
  for (double time = 0.0; time < end;) {
    const mpm::StepReport report = solver->step({0.0, -9.81}, {0.0, 0.0}, 1e300);
    time += report.dt;
    out.particle_steps += static_cast<double>(start.count());
    asleep += static_cast<double>(report.asleep);
  }
  out.share_asleep = asleep / out.particle_steps;
  std::vector<double> x;
  const mpm::Particles<2>& now = solver->particles();
  for (std::size_t p = 0; p < now.count(); ++p) {
    const auto k = static_cast<std::size_t>(now.identity[p]);
    if (k >= bed_columns * bed_rows) x.push_back(now.position[0][p]);
    if (std::hypot(now.position[0][p] - start.position[0][k], now.position[1][p] - start.position[1][k]) > cell)
      out.moved_mass += now.mass[p];
  }
  const auto front = x.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(x.size()));
  std::nth_element(x.begin(), front, x.end());
  out.front = *front;
  return out;
}

}  // namespace tailrun::bench

// Sleeping blocks in the explicit step (sleeping_blocks.hpp); included by explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

// Whether only sleeping particles reach the nodes of active block a.
template <int Dim, class Shape, bool Split, TransferName Transfer>
bool ExplicitSolver<Dim, Shape, Split, Transfer>::still(std::size_t a) const {
  if (!sleep_.active()) return false;
  for (const int b : grid_.tiles_around(a))
    if (b >= 0 && !sleep_.asleep(static_cast<std::size_t>(b))) return false;
  return true;
}

// Whether a sleeping block's nodes, which load(field) puts into `tile`, let it sleep on.
template <int Dim, class Shape, bool Split, TransferName Transfer>
template <class Load>
bool ExplicitSolver<Dim, Shape, Split, Transfer>::sleeps_on(std::size_t b, const Vec4* tile, Load load, double dt) {
  double fastest = 0.0;
  fields_.for_each_span(b, [&](const FieldSpan& span) {
    load(span.field);
    for (int n = 0; n < tile_nodes; ++n) {
      double squared = 0.0;
      for (int d = 0; d < Dim; ++d) squared += tile[n][d] * tile[n][d];
      fastest = std::max(fastest, squared);
    }
  });
  if (fastest < sleep_.speed() * sleep_.speed()) return sleep_.doze(b, dt);
  sleep_.wake(b);
  return false;
}

// m/s, of the stiffest material in block b: what the time step has to follow while its particles are at rest.
template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::wave_speed_in(std::size_t b) const {
  double fastest = 0.0;
  for (const Run& run : grid_.runs(b)) fastest = std::max(fastest, wave_speed_[run.material]);
  return fastest;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::lay_to_rest(std::size_t b, BlockMotion& motion) {
  motion.stopped += motion.kinetic;
  motion.kinetic = motion.fast = 0.0;
  motion.wave = wave_speed_in(b);
  motion.asleep = true;
  const auto still = [&](auto& columns) {
    for (auto& column : columns)
      if (!column.empty())
        std::fill(column.data() + grid_.first_particle(b), column.data() + grid_.last_particle(b), 0.0);
  };
  still(P_.velocity);
  still(P_.affine);
  still(P_.gradient);
}

}  // namespace tailrun::mpm

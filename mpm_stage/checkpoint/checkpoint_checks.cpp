#include "mpm_stage/checkpoint/checkpoint_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/shape_functions.hpp"

namespace tailrun::mpm {

namespace {

constexpr double largest_whole = 9007199254740992.0;  // 2^53: whole numbers up to here are exact as doubles
constexpr int farthest_block = (1 << 20) - 3;         // of the grid's keys
constexpr double largest_drift = 0.99;                // cells, the margin of a tile

// A point belongs to the block that holds its coordinate in cells plus this.
double shift_of(ShapeName shape) {
  switch (shape) {
    case ShapeName::linear:
      return LinearShape::shift;
    case ShapeName::quadratic:
      return QuadraticShape::shift;
    case ShapeName::cubic:
      return CubicShape::shift;
    case ShapeName::gimp:
      return GimpShape::shift;
  }
  return 0.0;
}

// Row by row: z slowest, x fastest.
template <int Dim>
bool comes_before(const std::array<int, Dim>& a, const std::array<int, Dim>& b) {
  return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
}

template <int Dim>
std::size_t active_blocks(const std::vector<std::array<int, Dim>>& occupied) {
  std::set<std::array<int, Dim>> active;
  for (const auto& block : occupied)
    for (int k = 0; k < Block<Dim>::neighbours; ++k) {
      auto index = block;
      const auto step = neighbour_step<Dim>(k);
      for (int d = 0; d < Dim; ++d) index[d] += step[d];
      active.insert(index);
    }
  return active.size();
}

template <class Row>
void check_times(const Hdf5Reader& file, const std::string& name, const std::vector<Row>& rows, double end) {
  if (rows.empty()) file.fail(name, "has no rows, but the row of the start is required");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double least = k == 0 ? 0.0 : rows[k - 1].time;
    if (!(rows[k].time >= least) || rows[k].time > end * (1.0 + 1e-9))
      file.fail(name, fmt::format("row {} is of {:g} s, but times must ascend from 0 to the run's {:g} s", k,
                                  rows[k].time, end));
  }
}

}  // namespace

long whole_attribute(const Hdf5Reader& file, const std::string& object, const std::string& name) {
  const double value = file.number_attribute(object, name);
  if (value != std::floor(value) || value < 0.0 || value > largest_whole)
    file.fail(object, fmt::format("attribute '{}' is {:g}, but a whole number in [0, 2^53] is required", name, value));
  return static_cast<long>(value);
}

template <int Dim>
void check_particles(const Hdf5Reader& file, const Particles<Dim>& P, const Particles<Dim>& like,
                     const std::vector<std::int32_t>& removed) {
  std::vector<char> seen(like.count(), 0);
  const auto once = [&](std::size_t identity, const char* where) {
    if (identity >= like.count())
      file.fail(where, fmt::format("{} is no row of the input, which has {}", identity, like.count()));
    if (seen[identity]) file.fail(where, fmt::format("particle {} is there twice", identity));
    seen[identity] = 1;
  };
  for (std::size_t p = 0; p < P.count(); ++p) {
    const auto i = static_cast<std::size_t>(P.identity[p]);
    once(i, "/particles/identity");
    if (P.mass[p] != like.mass[i] || P.material[p] != like.material[i])
      file.fail(P.mass[p] != like.mass[i] ? "/particles/mass" : "/particles/material",
                fmt::format("row {} is not that of particle {} of the input; rows are in another order", p, i));
    if (!(P.volume[p] > 0.0))
      file.fail("/particles/volume", fmt::format("entry {} is {:g}, but must be positive", p, P.volume[p]));
    if (P.strength[p] < 0.0 || P.plastic_strain[p] < 0.0)
      file.fail(P.strength[p] < 0.0 ? "/particles/strength" : "/particles/plastic_strain",
                fmt::format("entry {} is negative", p));
  }
  for (const std::int32_t identity : removed) once(static_cast<std::size_t>(identity), "/particles/removed");
  if (P.count() + removed.size() != like.count())
    file.fail("/particles", fmt::format("{} particles and {} that were removed, but the input has {}", P.count(),
                                        removed.size(), like.count()));
}

template <int Dim>
void check_blocks(const Hdf5Reader& file, const SolverState<Dim>& state, const Particles<Dim>& P, const Scene& scene,
                  const std::array<double, Dim>& origin) {
  if (!(state.drift >= 0.0 && state.drift <= largest_drift))
    file.fail("/numbers", fmt::format("attribute 'drift' is {:g}, but allowed is [0, {}]", state.drift, largest_drift));
  const double shift = shift_of(scene.solver.shape), slack = state.drift + 1e-6;
  for (std::size_t b = 0; b < state.blocks.size(); ++b) {
    for (const int index : state.blocks[b])
      if (std::abs(index) > farthest_block)
        file.fail("/grid/blocks", fmt::format("row {} is out of the grid's range of {} blocks", b, farthest_block));
    if (b > 0 && !comes_before<Dim>(state.blocks[b - 1], state.blocks[b]))
      file.fail("/grid/blocks", fmt::format("row {} does not come after the row before it", b));
    for (std::size_t p = state.first[b]; p < state.first[b + 1]; ++p)
      for (int d = 0; d < Dim; ++d) {
        const double cells = (P.position[d][p] - origin[d]) / scene.cell_size + shift;
        const double low = static_cast<double>(state.blocks[b][d]) * Block<Dim>::cells;
        if (!(cells >= low - slack && cells <= low + Block<Dim>::cells + slack))
          file.fail(fmt::format("/particles/position_{}", d),
                    fmt::format("entry {} is {:g} m, which is not in its block, row {} of /grid/blocks", p,
                                P.position[d][p], b));
      }
  }
}

template <int Dim>
void check_state(const Hdf5Reader& file, const SolverState<Dim>& state, const Scene& scene) {
  const auto length = [&](const char* name, std::size_t found, std::size_t wanted) {
    if (found != wanted) file.fail(name, fmt::format("has {} values, but {} are required", found, wanted));
  };
  length("/grid/wave_speed", state.wave_speed.size(), scene.materials.size());
  if (scene.solver.sleep.speed > 0.0) length("/grid/sleep_clocks", state.sleep_clocks.size(), state.blocks.size());
  const std::size_t nodes = active_blocks<Dim>(state.blocks) * static_cast<std::size_t>(Block<Dim>::nodes);
  length("/grid/meeting", state.meeting.size(), scene.solver.fields.several() ? nodes : 0);
  length("/grid/pond_shares", state.pond_shares.size(), scene.solver.ponds.size() * nodes);
  for (const double share : state.pond_shares)
    if (!(share >= 0.0 && share <= 1.0)) file.fail("/grid/pond_shares", "holds a value outside of [0, 1]");
  for (const double speed : state.wave_speed)
    if (speed < 0.0) file.fail("/grid/wave_speed", "holds a negative speed");
  if (!(state.next_dt > 0.0))
    file.fail("/numbers", fmt::format("attribute 'next_time_step' is {:g}, but must be positive", state.next_dt));
  for (const auto& block : state.grip.blocks)
    for (const int index : block)
      if (std::abs(index) > farthest_block) file.fail("/grid/grip_blocks", "holds a block out of the grid's range");
}

void check_series(const Hdf5Reader& file, const RunState& run, const Scene& scene) {
  const double time = run.record.time;
  if (!(time >= 0.0 && time <= scene.end_time * (1.0 + 1e-9)))
    file.fail("/numbers",
              fmt::format("attribute 'time' is {:g} s, but the run goes from 0 to {:g} s", time, scene.end_time));
  check_times(file, "/series/ledger", run.ledger, time);
  check_times(file, "/series/front", run.front, time);
  if (run.ledger.size() != run.front.size())
    file.fail("/series/front",
              fmt::format("has {} rows, but /series/ledger has {}", run.front.size(), run.ledger.size()));
  for (std::size_t k = 0; k < run.ledger.size(); ++k) {
    const LedgerRow& r = run.ledger[k];
    // With FMPM what transfers and impacts cost is not known, nor what follows from it.
    for (const double x : {r.kinetic, r.elastic, r.gravitational, r.work.plastic, r.work.friction, r.work.contact,
                           r.work.damping, r.work.external, r.work.removed, r.work.pore_pressure, r.work.crowding,
                           r.mass, r.momentum[0], r.momentum[1], r.momentum[2], r.angular_momentum})
      if (!std::isfinite(x)) file.fail("/series/ledger", fmt::format("row {} has a value that is not finite", k));
  }
  const std::size_t points = std::max<std::size_t>(scene.output.points.size(), 1);
  for (std::size_t k = 0; k < run.front.size(); ++k) {
    const FrontRow& r = run.front[k];
    if (r.points.size() != 2 * points)
      file.fail("/series/front", fmt::format("follows {} points, but the case {}", r.points.size() / 2, points));
    // Only the front of what has flowed, and points that have left, may be unknown.
    for (const double x :
         {r.front, r.robust_front, r.flowed_mass, r.top, r.centre_x, r.centre_y, r.rms_speed, r.maximum_speed})
      if (!std::isfinite(x)) file.fail("/series/front", fmt::format("row {} has a value that is not finite", k));
  }
  if (!run.bodies.empty()) check_times(file, "/series/bodies", run.bodies, time);
  if (!run.sections.empty()) check_times(file, "/series/sections", run.sections, time);
}

template void check_particles<2>(const Hdf5Reader&, const Particles<2>&, const Particles<2>&,
                                 const std::vector<std::int32_t>&);
template void check_particles<3>(const Hdf5Reader&, const Particles<3>&, const Particles<3>&,
                                 const std::vector<std::int32_t>&);
template void check_blocks<2>(const Hdf5Reader&, const SolverState<2>&, const Particles<2>&, const Scene&,
                              const std::array<double, 2>&);
template void check_blocks<3>(const Hdf5Reader&, const SolverState<3>&, const Particles<3>&, const Scene&,
                              const std::array<double, 3>&);
template void check_state<2>(const Hdf5Reader&, const SolverState<2>&, const Scene&);
template void check_state<3>(const Hdf5Reader&, const SolverState<3>&, const Scene&);

}  // namespace tailrun::mpm

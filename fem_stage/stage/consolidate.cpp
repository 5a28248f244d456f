#include "fem_stage/stage/consolidate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "common/progress.hpp"
#include "common/vtkhdf.hpp"
#include "common/warnings.hpp"
#include "fem_stage/model/stage_freedoms.hpp"
#include "fem_stage/output/history.hpp"
#include "fem_stage/output/snapshot_plan.hpp"
#include "fem_stage/output/state_file.hpp"
#include "fem_stage/stage/liquefaction.hpp"

namespace tailrun::fem {
namespace {

constexpr int steps_before_growth = 4;  // at one length, so that its matrix serves more than once

double largest_ratio(const Model& model, const State& state) {
  const auto ratio = excess_pore_pressure_ratio(model, state);
  return ratio.empty() ? 0.0 : *std::max_element(ratio.begin(), ratio.end());
}

double largest_size(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

void bring_to_rest(State& state) {
  for (auto* array : {&state.velocity, &state.acceleration}) std::fill(array->begin(), array->end(), 0.0);
}

}  // namespace

ConsolidationReport run_consolidation(const Model& model, MaterialPoints& points, State& state,
                                      const std::filesystem::path& folder) {
  const auto wall_start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  };
  const ConsolidationOptions& options = model.options->consolidation;
  std::filesystem::create_directories(folder);
  ConsolidationReport report;
  report.start_time = state.time;
  report.start_velocity = largest_size(state.velocity);
  report.first_ratio = report.last_ratio = largest_ratio(model, state);
  const std::vector<double> first_displacement = state.displacement;
  if (report.start_velocity > options.rest_velocity)
    add_warning(fmt::format("consolidation starts from a state that moves at up to {:.3g} m/s; its motion is left out",
                            report.start_velocity));

  points.set_post_shaking(options.post_shaking);
  const Freedoms freedoms = consolidation_freedoms(model);
  ElementForces forces(model, 0.0, model.options->shake.large_displacement);
  if (auto floor = make_residual_floor(model, state)) forces.set_residual_floor(std::move(*floor));
  if (auto scale = make_softening_scale(model, state)) forces.set_softening_scale(std::move(*scale));
  forces.reset(points, state);
  NewmarkOptions newmark_options;
  newmark_options.gamma = newmark_options.beta = newmark_options.theta = 1.0;  // from rest: backward Euler
  newmark_options.tolerance = options.tolerance;
  newmark_options.max_iterations = options.max_iterations;
  Newmark newmark(model, freedoms, newmark_options, {}, [&](double time, std::span<double> force) {
    for (std::size_t n = 0; n < model.nodes(); ++n) force[2 * n + 1] -= model.nodal_mass[n] * model.options->gravity;
    for (const auto& item : model.loads)
      if (item.in_shake) add_load(item, time, force);
  });

  History history(model, folder);
  QualitySeries quality(model, folder);
  const auto save = [&](const std::string& name) {
    write_state(folder / name, model, state, points, 0.0, 0.0, state.rigid_displacement);
    report.snapshots.push_back(name);
    report.snapshot_times.push_back(state.time);
    write_file_series(folder / "snapshots.vtkhdf.series", report.snapshots, report.snapshot_times);
  };
  const auto record = [&] {
    history.record(state, {0.0, 0.0, state.rigid_displacement});
    quality.record(state, newmark.counts(), seconds());
  };
  bring_to_rest(state);
  std::fill(state.pressure_rate.begin(), state.pressure_rate.end(), 0.0);
  record();
  std::set<double> wanted;
  for (const double after : options.snapshots)
    if (after < options.duration)
      wanted.insert(report.start_time + after);
    else
      add_warning(
          fmt::format("/consolidation/snapshots: {:g} s: not before the end ({:g} s): not written; the last state is "
                      "consolidated.h5",
                      after, options.duration));
  const SnapshotPlan plan(std::vector<double>(wanted.begin(), wanted.end()));

  Progress progress("consolidate", options.duration, "s");
  const double end = report.start_time + options.duration;
  double length = options.first_step;
  int good = 0;
  long steps = 0;
  while (state.time < end * (1.0 - 1e-12) && (options.ratio_limit == 0.0 || report.last_ratio > options.ratio_limit)) {
    double target = std::min(end, state.time + length);
    if (!wanted.empty()) target = std::min(target, *wanted.begin());
    const double dt = target - state.time;
    const StepResult result = newmark.step(state, points, forces, dt);
    if (!result.converged) {
      ++newmark.counts().halvings;
      length = 0.5 * dt;
      good = 0;
      if (length < options.first_step * std::exp2(-options.max_halvings)) {
        report.failure =
            fmt::format("consolidation at t = {:.6g} s with a step of {:.2e} s: {}", state.time, dt, result.reason);
        break;
      }
      continue;
    }
    state.time = target;
    bring_to_rest(state);
    report.last_ratio = largest_ratio(model, state);
    record();
    if (!wanted.empty() && state.time >= *wanted.begin()) {
      wanted.erase(wanted.begin());
      save(plan.name(state.time));
    }
    if (++good % steps_before_growth == 0) length = std::min(options.largest_step, length * options.growth);
    progress.update(state.time - report.start_time, ++steps, fmt::format("largest r_u {:.3f}", report.last_ratio));
  }
  progress.finish(report.failure.empty() ? "" : "stopped");
  points.set_post_shaking(false);
  save(report.failure.empty() ? std::string("consolidated.h5") : fmt::format("last_good_t{:07.4f}.h5", state.time));
  history.finish();
  quality.finish();
  for (std::size_t n = 0; n < model.nodes(); ++n)
    report.settlement =
        std::max(report.settlement, std::hypot(state.displacement[2 * n] - first_displacement[2 * n],
                                               state.displacement[2 * n + 1] - first_displacement[2 * n + 1]));
  report.end_time = state.time;
  report.counts = newmark.counts();
  report.wall_seconds = seconds();
  return report;
}

}  // namespace tailrun::fem

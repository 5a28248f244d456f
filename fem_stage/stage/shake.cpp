#include "fem_stage/stage/shake.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/progress.hpp"
#include "common/vtkhdf.hpp"
#include "common/warnings.hpp"
#include "fem_stage/model/stage_freedoms.hpp"
#include "fem_stage/output/snapshot_plan.hpp"
#include "fem_stage/output/state_file.hpp"
#include "fem_stage/solver/energy_watch.hpp"
#include "fem_stage/stage/free_field.hpp"
#include "fem_stage/stage/liquefaction.hpp"
#include "fem_stage/stage/shake_checkpoint.hpp"

namespace tailrun::fem {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Lysmer & Kuhlemeyer (1969) for a compliant base: dashpots of the rock's shear impedance, and the force that makes an
// outcrop motion come up through them (Joyner & Chen 1975): F = rho V_s A v_outcrop.
std::vector<Dashpot> base_dashpots(const Model& model) {
  const auto& boundaries = model.options->boundaries;
  std::vector<Dashpot> dashpots;
  if (boundaries.base != BaseKind::lysmer_dashpot) return dashpots;
  for (std::size_t i = 0; i < model.base_nodes.size(); ++i) {
    const double area = model.base_area[i];
    dashpots.push_back(
        {model.base_nodes[i], freedom_ux, boundaries.rock_density * boundaries.rock_shear_velocity * area});
    if (boundaries.rock_p_velocity > 0.0)
      dashpots.push_back(
          {model.base_nodes[i], freedom_uy, boundaries.rock_density * boundaries.rock_p_velocity * area});
  }
  return dashpots;
}

BaseMotion rigid_base_motion(const Model& model, const Motion& motion, double time, double displacement) {
  if (model.options->boundaries.base != BaseKind::rigid) return {};
  return {motion.acceleration_at(time), motion.velocity_at(time), displacement};
}

// Advances by dt; on failure by two halves, down to dt / 2^max_halvings. Returns the reason when that is not enough.
class Stepper {
 public:
  Stepper(const Model& model, MaterialPoints& points, State& state, ElementForces& forces, Newmark& newmark,
          EnergyLedger& ledger, std::function<void(double before)> accepted)
      : model_(model),
        points_(points),
        state_(state),
        forces_(forces),
        newmark_(newmark),
        ledger_(ledger),
        accepted_(std::move(accepted)),
        last_load_(2 * model.nodes(), 0.0) {}

  std::string advance(double dt, int halvings_left) {
    recorder_.before(state_, last_load_);
    const double before = state_.time;
    const StepResult result = newmark_.step(state_, points_, forces_, dt);
    if (result.converged) {
      recorder_.after(model_, state_, forces_, newmark_, ledger_);
      last_load_.assign(newmark_.last_load().begin(), newmark_.last_load().end());
      accepted_(before);
      return {};
    }
    if (halvings_left == 0)
      return fmt::format("at t = {:.5f} s with a step of {:.2e} s: {}", state_.time, dt, result.reason);
    ++newmark_.counts().halvings;
    log_debug("t = {:.5f} s: step of {:.2e} s cut: {}", state_.time, dt, result.reason);
    for (int half = 0; half < 2; ++half)
      if (std::string reason = advance(0.5 * dt, halvings_left - 1); !reason.empty()) return reason;
    return {};
  }
  void start_load(std::vector<double> load) { last_load_ = std::move(load); }
  const std::vector<double>& last_load() const { return last_load_; }

 private:
  const Model& model_;
  MaterialPoints& points_;
  State& state_;
  ElementForces& forces_;
  Newmark& newmark_;
  EnergyLedger& ledger_;
  std::function<void(double)> accepted_;  // what else goes on with the time, from `before` to the state's
  EnergyRecorder recorder_;
  std::vector<double> last_load_;
};

// When a checkpoint is to be written: every few minutes, and before an interruption ends the run.
class CheckpointClock {
 public:
  explicit CheckpointClock(const ShakeControl& control) : control_(control) {}

  bool is_due(long step) {
    if (control_.interruption) reason_ = control_.interruption(step);
    return !reason_.empty() || seconds_since(last_) > 60.0 * control_.checkpoint_interval;
  }
  // Throws InterruptedError when that is why it was written.
  void saved() {
    if (!reason_.empty())
      throw InterruptedError(fmt::format("interrupted by {}; to go on: {}", reason_, control_.resume_command));
    last_ = std::chrono::steady_clock::now();
  }

 private:
  const ShakeControl& control_;
  std::string reason_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

Motion case_motion(const FemCase& options) {
  if (options.shake.motion.empty()) return {.name = "none", .time_step = 0.0, .acceleration = {}, .velocity = {}};
  Motion motion = read_motion(options.shake.motion);
  const double recorded = motion.peak_acceleration();
  if (options.shake.peak_acceleration > 0.0)
    motion = scaled_to_peak(std::move(motion), options.shake.peak_acceleration);
  warn_about_motion(motion, recorded, options.shake.time_step, options.shake.duration);
  return motion;
}

void check_shake_output(const FemCase& options, double state_bytes, const std::filesystem::path& folder) {
  const OutputOptions& output = options.output;
  const ShakeOptions& shake = options.shake;
  const double most = shake.duration / std::max(output.history_interval, shake.time_step);
  const double columns = 1.0 + 7.0 * static_cast<double>(output.points.size()) +
                         6.0 * static_cast<double>(output.elements.size()) + 12.0;  // quality.csv's
  const double regular =
      output.snapshot_interval > 0.0 ? shake.duration / std::max(output.snapshot_interval, shake.time_step) : 0.0;
  const double snapshots = regular + static_cast<double>(output.snapshots.size());
  constexpr double number = 12.0;  // bytes of one in a table
  const double bytes = snapshots * state_bytes + most * columns * number;
  std::filesystem::create_directories(folder);
  std::error_code unknown;
  const auto space = std::filesystem::space(folder.empty() ? "." : folder, unknown);
  if (unknown || bytes <= static_cast<double>(space.available)) return;
  throw InputError(fmt::format(
      "/output: {:.3g} snapshots of {:.3g} MB and {:.3g} rows of histories make {:.3g} GB, but {} has {:.3g} GB free; "
      "ask "
      "for fewer (/output/snapshot_interval, history_interval)",
      snapshots, 1e-6 * state_bytes, most, 1e-9 * bytes, folder.string(), 1e-9 * static_cast<double>(space.available)));
}

ShakeReport run_shake(const Model& model, MaterialPoints& points, State& state, const Motion& motion,
                      const std::filesystem::path& folder, const ShakeControl& control) {
  const auto start = std::chrono::steady_clock::now();
  const ShakeOptions& options = model.options->shake;
  const OutputOptions& output = model.options->output;
  const bool rigid = model.options->boundaries.base == BaseKind::rigid;
  std::filesystem::create_directories(folder);
  ShakeReport report;

  // 1. Freedoms, dashpots and loads of this stage.
  const Freedoms freedoms = shaking_freedoms(model);
  const auto base_only = base_dashpots(model);
  FreeField free_field(model, points, state);  // of the soil at the start, also for a run that goes on
  const std::filesystem::path checkpoint = folder / shake_checkpoint_name;
  std::optional<ShakeProgress> resumed;
  if (control.resume) {
    resumed = read_shake_checkpoint(checkpoint, model, state, points);
    free_field.restore(resumed->free_field);
    log_info("going on from {}: t = {:.6g} s, step {}", checkpoint.string(), state.time, resumed->counts.steps);
  } else {
    std::filesystem::remove(checkpoint);
  }
  auto dashpots = base_only;
  dashpots.insert(dashpots.end(), free_field.dashpots().begin(), free_field.dashpots().end());
  const auto load = [&](double time, std::span<double> force) {
    const double base_acceleration = rigid ? motion.acceleration_at(time) : 0.0;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      force[2 * n] -= model.nodal_mass[n] * base_acceleration;
      force[2 * n + 1] -= model.nodal_mass[n] * model.options->gravity;
    }
    const double velocity = rigid ? 0.0 : motion.velocity_at(time);
    for (const auto& dashpot : base_only)
      if (dashpot.freedom == freedom_ux)
        force[2 * static_cast<std::size_t>(dashpot.node)] += dashpot.coefficient * velocity;
    for (const auto& item : model.loads)
      if (item.in_shake) add_load(item, time, force);
    free_field.add_forces(time, force);
  };

  // 2. The solver, its matrix made from the geostatic moduli.
  const double damping = options.damping_ratio > 0.0
                             ? 2.0 * options.damping_ratio / (2.0 * std::numbers::pi * options.damping_frequency)
                             : 0.0;
  ElementForces forces(model, damping, options.large_displacement);
  if (auto floor = make_residual_floor(model, state)) forces.set_residual_floor(std::move(*floor));
  if (auto scale = make_softening_scale(model, state)) forces.set_softening_scale(std::move(*scale));
  const auto observe_soil = [&] {
    if (forces.residual_floor()) observe_liquefaction(model, state, *forces.residual_floor());
    if (forces.softening_scale()) observe_softening(model, state, *forces.softening_scale());
  };
  observe_soil();
  forces.reset(points, state);
  for (std::size_t i = 0; !resumed && i < 2 * model.nodes(); ++i)  // what a restart brings along
    report.ledger.external_work += 0.5 * model.nodal_mass[i / 2] * state.velocity[i] * state.velocity[i];
  NewmarkOptions newmark_options{options.gamma,
                                 options.beta,
                                 options.theta,
                                 options.tolerance,
                                 options.max_iterations,
                                 options.refactor_above,
                                 options.acceleration_depth};
  Newmark newmark(model, freedoms, newmark_options, dashpots, load);
  const auto accepted = [&](double before) {
    if (rigid)
      state.rigid_displacement +=
          0.5 * (motion.velocity_at(before) + motion.velocity_at(state.time)) * (state.time - before);
    free_field.observe(state);
  };
  Stepper stepper(model, points, state, forces, newmark, report.ledger, accepted);
  std::vector<double> first_load(2 * model.nodes(), 0.0);
  load(state.time, first_load);
  stepper.start_load(resumed ? resumed->last_load : std::move(first_load));

  // 3. Steps, with output on the way.
  const double wall_before = resumed ? resumed->wall_seconds : 0.0,
               material_before = resumed ? resumed->material_seconds : 0.0;
  History history(model, folder);
  QualitySeries quality(model, folder);
  EnergyWatch energy;
  Progress progress("shake", options.duration, "s");
  std::size_t next_snapshot = 0;
  double next_record = 0.0, next_regular = output.snapshot_interval;
  const double slack = 1e-6 * options.time_step;
  const SnapshotPlan plan({options.duration, options.time_step}, output.snapshots, output.snapshot_interval);
  // An interval far below the step means every step; adding it up to the next one would take for ever.
  const double history_interval = std::max(output.history_interval, 1e-3 * options.time_step),
               snapshot_interval =
                   output.snapshot_interval > 0.0 ? std::max(output.snapshot_interval, 1e-3 * options.time_step) : 0.0;
  const auto keep_state = [&](const std::string& name, const BaseMotion& base) {
    write_state(folder / name, model, state, points, base.velocity, base.acceleration, base.displacement);
    report.snapshots.push_back(name);
    report.snapshot_times.push_back(state.time);
    write_file_series(folder / "snapshots.vtkhdf.series", report.snapshots, report.snapshot_times);
  };
  const auto write_outputs = [&] {
    const auto output_start = std::chrono::steady_clock::now();
    const BaseMotion base = rigid_base_motion(model, motion, state.time, state.rigid_displacement);
    if (state.time >= next_record - slack) {
      history.record(state, base);
      quality.record(state, newmark.counts(), wall_before + seconds_since(start));
      while (next_record <= state.time + slack) next_record += history_interval;
    }
    bool wanted = false;
    while (next_snapshot < output.snapshots.size() && state.time >= output.snapshots[next_snapshot] - slack) {
      ++next_snapshot;
      wanted = true;
    }
    if (snapshot_interval > 0.0 && state.time >= next_regular - slack) {
      next_regular += snapshot_interval;
      wanted = true;
    }
    if (wanted) {
      const std::string name = plan.name(state.time);
      keep_state(name, base);
    }
    report.output_seconds += seconds_since(output_start);
  };
  const auto save = [&] {
    ShakeProgress now;
    now.ledger = report.ledger;
    now.counts = newmark.counts();
    now.matrix = newmark.memory();
    now.energy_open_since = energy.open_since();
    now.hourglass_since = energy.hourglass_since();
    now.hourglass_work.assign(forces.hourglass_work().begin(), forces.hourglass_work().end());
    now.last_load = stepper.last_load();
    now.free_field = free_field.memory();
    now.quality = quality.rows();
    now.history_lines = history.lines();
    now.quality_lines = quality.lines();
    now.snapshots = report.snapshots;
    now.snapshot_times = report.snapshot_times;
    now.next_record = next_record;
    now.next_regular = next_regular;
    now.next_snapshot = next_snapshot;
    now.wall_seconds = wall_before + seconds_since(start);
    now.output_seconds = report.output_seconds;
    now.material_seconds = material_before + forces.material_seconds();
    write_shake_checkpoint(checkpoint, model, state, points, now);
  };
  if (resumed) {
    report.ledger = resumed->ledger;
    newmark.restore(resumed->matrix, resumed->counts, forces);
    energy.restore(resumed->energy_open_since, resumed->hourglass_since);
    forces.restore_hourglass_work(resumed->hourglass_work);
    history.restore(resumed->history_lines);
    quality.restore(resumed->quality, resumed->quality_lines);
    report.snapshots = resumed->snapshots;
    report.snapshot_times = resumed->snapshot_times;
    report.output_seconds = resumed->output_seconds;
    next_record = resumed->next_record;
    next_regular = resumed->next_regular;
    next_snapshot = resumed->next_snapshot;
  } else if (state.time > 0.0) {  // a restart: what lies before it has been written
    while (next_snapshot < output.snapshots.size() && output.snapshots[next_snapshot] <= state.time + slack)
      ++next_snapshot;
    while (snapshot_interval > 0.0 && next_regular <= state.time + slack) next_regular += snapshot_interval;
    next_record = state.time;
  }
  if (!resumed) write_outputs();
  CheckpointClock clock(control);
  const long total_steps = std::lround(std::ceil(options.duration / options.time_step - 1e-9));
  for (long step = 1; step <= total_steps && report.failure.empty(); ++step) {
    const double before = state.time,
                 target = std::min(options.duration, options.time_step * static_cast<double>(step));
    if (target <= before + slack) continue;  // a restart
    report.failure = stepper.advance(target - before, options.max_halvings);
    if (!report.failure.empty()) break;
    energy.observe(report.ledger, target);
    state.time = target;  // no drift from adding up steps
    const auto ratio = excess_pore_pressure_ratio(model, state);
    for (std::size_t e = 0; e < model.count(); ++e)
      state.max_pore_pressure_ratio[e] = std::max(state.max_pore_pressure_ratio[e], ratio[e]);
    observe_soil();
    write_outputs();
    if (!quality.rows().empty())
      progress.update(state.time, step,
                      fmt::format("max displacement {:.2f} m", quality.rows().back().largest_displacement));
    if (state.time >= options.duration || !clock.is_due(step)) continue;
    save();
    clock.saved();
  }
  progress.finish(report.failure.empty() ? "" : "stopped");

  // 4. What came of it.
  if (!report.failure.empty()) {
    const BaseMotion base = rigid_base_motion(model, motion, state.time, state.rigid_displacement);
    const std::string name = fmt::format("last_good_t{:07.4f}.h5", state.time);
    keep_state(name, base);
  }
  history.finish();
  quality.finish();
  report.end_time = state.time;
  report.energy_open_since = energy.open_since();
  report.hourglass_since = energy.hourglass_since();
  if (const auto text = energy.warning(model, report.ledger, forces.hourglass_work()); !text.empty()) add_warning(text);
  report.counts = newmark.counts();
  report.quality = quality.rows();
  report.window = find_transfer_window(report.quality, motion);
  if (forces.residual_floor()) report.liquefaction = liquefaction_summary(model, *forces.residual_floor());
  report.material_seconds = material_before + forces.material_seconds();
  report.wall_seconds = wall_before + seconds_since(start);
  if (report.failure.empty()) std::filesystem::remove(checkpoint);
  return report;
}

}  // namespace tailrun::fem

#include "mpm_stage/run/runout.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/application.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/log.hpp"
#include "common/progress.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/checkpoint/checkpoint.hpp"
#include "mpm_stage/output/body_series.hpp"
#include "mpm_stage/output/energy_remarks.hpp"
#include "mpm_stage/output/energy_watch.hpp"
#include "mpm_stage/output/frames.hpp"
#include "mpm_stage/output/front.hpp"
#include "mpm_stage/output/ledger.hpp"
#include "mpm_stage/output/section_series.hpp"
#include "mpm_stage/output/summary.hpp"
#include "mpm_stage/run/schedule.hpp"
#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <int Dim>
std::array<double, Dim> in_dimension(const std::array<double, 3>& a) {
  std::array<double, Dim> b;
  for (int d = 0; d < Dim; ++d) b[d] = a[d];
  return b;
}

template <int Dim>
Walls<Dim> in_dimension(const Walls<3>& w) {
  Walls<Dim> b;
  b.bounded = w.bounded;
  b.leaving = w.leaving;
  for (int d = 0; d < Dim; ++d) {
    b.low[d] = w.low[d];
    b.high[d] = w.high[d];
    for (int s = 0; s < 2; ++s) {
      b.side[d][s].kind = w.side[d][s].kind;
      b.side[d][s].friction = w.side[d][s].friction;
    }
  }
  for (const MovingBody<3>& body : w.bodies) {
    MovingBody<Dim> m{body.name, in_dimension<Dim>(body.low), in_dimension<Dim>(body.high), body.time, {}};
    for (const auto& v : body.velocity) m.velocity.push_back(in_dimension<Dim>(v));
    b.bodies.push_back(std::move(m));
  }
  return b;
}

std::vector<std::string> names_of(const std::vector<MovingBody<3>>& bodies) {
  std::vector<std::string> names;
  for (const auto& b : bodies) names.push_back(b.name);
  return names;
}

// One run with its solver and records. Everything that changes from step to step is in the solver, in `record_`, in the
// schedules and in the records, and all of that is in a checkpoint.
template <int Dim>
class Runout {
 public:
  Runout(const Scene& scene, const std::filesystem::path& folder, const Provenance& provenance,
         const RunControl& control)
      : scene_(scene),
        folder_(folder),
        checkpoint_(folder / "checkpoint.h5"),
        provenance_(provenance),
        control_(control),
        gravity_(in_dimension<Dim>(scene.gravity)),
        solver_(make_solver<Dim>(scene.solver, scene.cell_size, in_dimension<Dim>(scene.origin),
                                 solver_particles<Dim>(scene), scene.materials, scene.terrain,
                                 in_dimension<Dim>(scene.walls))),
        ledger_(gravity_),
        front_(scene),
        bodies_(names_of(scene.walls.bodies)),
        sections_(scene),
        frames_(folder / "frames", provenance, scene.output.frame_precision) {}

  void run() {
    if (control_.resume)
      resume();
    else
      begin();
    last_checkpoint_ = Clock::now();
    Progress progress("mpm", scene_.end_time, "s");
    try {
      steps(progress);
    } catch (const ComputationError& error) {
      // The frames so far are the last good state; the records up to here are kept beside them.
      record_.stop_reason = fmt::format("failed at t = {:.6g} s: {}", record_.time, error.what());
      finish();
      throw ComputationError(fmt::format("t = {:.6g} s: {}{}", record_.time, error.what(), last_good_state()));
    }
    if (record_.stop_reason.empty()) record_.stop_reason = "end time";

    // The last state and the summary; a run that is over has no use for its checkpoint.
    if (scene_.output.frame_interval > 0.0)
      frames_.write(particle_set<Dim>(scene_, solver_->particles(), record_.time));
    progress.finish(record_.stop_reason);
    if (ledger_.rows().back().time < record_.time) sample();
    for (const std::string& remark :
         energy_remarks(ledger_.rows().front(), ledger_.rows().back(), ledger_.turnover(), flows()))
      add_warning(remark);
    finish();
    std::filesystem::remove(checkpoint_);
    const FrontRow& f = front_.rows().back();
    const std::string flow =
        f.flowed_mass > 0.0
            ? fmt::format("{:.4g} t moved by more than {:g} m, runout {:.2f} m from the toe at {:.2f} m",
                          f.flowed_mass / 1e3, scene_.output.flow_distance, front_.runout(f.flow_front), front_.toe())
            : fmt::format("nothing moved by more than {:g} m", scene_.output.flow_distance);
    // What a reader has to know before the runout: whether it is one.
    std::string motion;
    if (record_.stop_reason != "at rest" && f.rms_speed > scene_.rest.speed) {
      const double front = front_.front_speed(scene_.rest.duration);
      motion = fmt::format(", soil still in motion (root mean square {:.2g} m/s{})", f.rms_speed,
                           std::isfinite(front) ? fmt::format(", the flow's front {:.2g} m/s", front) : "");
    }
    const double turnover = std::max(ledger_.turnover(), 1e-300), lost = ledger_.rows().back().lost;
    const std::string energy =
        flows() ? fmt::format("of {:.4g} J turned over the scheme lost {:.1f} %, residual {:.2f} %", ledger_.turnover(),
                              100.0 * lost / turnover, 100.0 * ledger_.rows().back().residual / turnover)
                : fmt::format("{:.4g} J turned over, {:.4g} J of it lost by the scheme", ledger_.turnover(), lost);
    if (!quiet())
      fmt::print("{}: {} after {:.3f} s{}, {} steps; {}; {}\n", scene_.title, record_.stop_reason, record_.time, motion,
                 record_.steps, flow, energy);
  }

 private:
  // Where next to nothing does, shares of the little that settling turns over say nothing.
  bool flows() const {
    constexpr double next_to_nothing = 0.01;  // of the mass
    return front_.rows().back().flowed_mass > next_to_nothing * ledger_.rows().back().mass;
  }

  double until_next_event(double time) const {
    const double next = std::min({series_.next(), frame_.next(), scene_.end_time});
    return next > time ? next - time : 1e300;
  }

  // Sets the particles on the grid and records the start.
  void begin() {
    std::filesystem::remove(checkpoint_);
    series_.advance();
    frame_.advance();
    solver_->start(until_next_event(0.0));
    record_.first_unbalanced = solver_->unbalanced_force_ratio(gravity_);
    warn_if_unbalanced();
    sample();
    if (scene_.output.frame_interval > 0.0) frames_.write(particle_set<Dim>(scene_, solver_->particles(), 0.0));
    record_.setup_seconds = seconds_since(start_);
    log_info(
        "{} particles in {} blocks of {} cells, first time step {:.3g} s, out-of-balance forces {:.3g} of the weight",
        solver_->particles().count(), solver_->grid().occupied(), Block<Dim>::nodes, solver_->next_dt(),
        record_.first_unbalanced);
  }

  // A state at rest that was handed over has borne its own weight so far. One that moves has not, and its stresses come
  // from elements that liquefy one by one: the main case begins at 0.5 to 0.8. Scenes made here may begin without any
  // stress.
  void warn_if_unbalanced() const {
    constexpr double rest = 1e-3, most_at_rest = 0.5, most_moving = 2.0;  // m/s; 1
    if (scene_.inputs.empty()) return;
    const auto& velocity = scene_.particles.velocity;
    const bool at_rest = std::all_of(velocity.begin(), velocity.end(), [](double v) { return std::fabs(v) < rest; });
    const double most = at_rest ? most_at_rest : most_moving;
    if (!(record_.first_unbalanced > most)) return;
    add_warning(
        fmt::format("forces are out of balance by {:.2g} of the weight at the start, though a state {} has less than "
                    "{:g}: do stresses, "
                    "pore pressures and water outside belong together, are faces free that carry stress, and does the "
                    "ground lie where "
                    "the soil ends?",
                    record_.first_unbalanced, at_rest ? "at rest" : "in motion", most));
  }

  void resume() {
    if (!std::filesystem::exists(checkpoint_))
      throw InputError(
          fmt::format("{}: no such file, so there is nothing to go on from: the run has not begun, has "
                      "reached its end, or time/checkpoint_interval is 0. Run it without --resume",
                      checkpoint_.string()));
    RunState state = read_checkpoint<Dim>(checkpoint_, *solver_, scene_, provenance_);
    record_ = state.record;
    series_ = Schedule(scene_.output.series_interval, state.series_count);
    frame_ = Schedule(scene_.output.frame_interval, state.frame_count);
    ledger_.restore(std::move(state.ledger), state.largest_kinetic);
    front_.restore(std::move(state.front));
    bodies_.restore(std::move(state.bodies));
    sections_.restore(std::move(state.sections));
    frames_.restore(std::move(state.frame_names), std::move(state.frame_times));
    wall_seconds_before_ = record_.wall_seconds;
    log_info("going on from {}: t = {:.6g} s, step {}", checkpoint_.string(), record_.time, record_.steps);
  }

  void save() {
    // Frames are written by a thread of their own, and the HDF5 library by one thread at a time.
    frames_.wait();
    RunState state;
    state.record = record_;
    state.record.wall_seconds = wall_seconds_before_ + seconds_since(start_);
    state.series_count = series_.count();
    state.frame_count = frame_.count();
    state.frame_names = frames_.names();
    state.frame_times = frames_.times();
    state.ledger = ledger_.rows();
    state.largest_kinetic = ledger_.largest_kinetic();
    state.front = front_.rows();
    state.bodies = bodies_.rows();
    state.sections = sections_.rows();
    write_checkpoint<Dim>(checkpoint_, *solver_, scene_.cell_size, std::move(state), provenance_);
    last_checkpoint_ = Clock::now();
  }

  void steps(Progress& progress) {
    const double shaking_end = scene_.base.shaken() ? scene_.base.motion->duration() - scene_.base.start : 0.0;
    while (record_.time < scene_.end_time * (1.0 - 1e-12)) {
      std::array<double, Dim> inertial{};
      if (scene_.base.shaken()) {
        const double a =
            scene_.base.motion->acceleration_at(scene_.base.start + record_.time + 0.5 * solver_->next_dt());
        for (int d = 0; d < Dim; ++d) inertial[d] = -a * scene_.base.direction[d];
      }
      // An event that falls on the end of this step is over by the next one.
      const double after = record_.time + solver_->next_dt();
      const bool series_due = series_.due(after), frame_due = frame_.due(after);
      if (series_due) series_.advance();
      if (frame_due) frame_.advance();
      const StepReport report = solver_->step(gravity_, inertial, until_next_event(after));
      record_.time = after;
      ++record_.steps;
      record_.particle_steps += static_cast<double>(solver_->particles().count());
      record_.asleep_particle_steps += static_cast<double>(report.asleep);
      record_.dt_min = std::min(record_.dt_min, report.dt);
      record_.dt_max = std::max(record_.dt_max, report.dt);
      record_.largest_kinetic = std::max(record_.largest_kinetic, report.kinetic_energy);
      ledger_.follow(EnergyWatch::spent(report, solver_->work()));
      if (!series_due && watch_.due(report, solver_->work()))
        looked(ledger_.look(record_.time, *solver_, scene_.energy_growth_limit), report);
      if ((series_due || frame_due) && record_event(report, series_due, frame_due, shaking_end, progress)) return;
      mind_checkpoints();
    }
  }

  void looked(const LedgerRow& row, const StepReport& report) {
    double g2 = 0.0;
    for (const double g : gravity_) g2 += g * g;
    watch_.looked(report, row, std::sqrt(g2 * row.mass), scene_.energy_growth_limit * ledger_.turnover());
  }

  // A row of each series.
  void sample() {
    ledger_.sample(record_.time, *solver_, scene_.energy_growth_limit);
    front_.sample(record_.time, solver_->particles());
    bodies_.sample(record_.time, solver_->bodies());
    sections_.sample(record_.time, solver_->particles());
  }

  // Returns whether all has come to rest.
  bool record_event(const StepReport& report, bool series_due, bool frame_due, double shaking_end, Progress& progress) {
    const auto since = Clock::now();
    if (series_due) {
      sample();
      looked(ledger_.rows().back(), report);
      const FrontRow& row = front_.rows().back();
      progress.update(record_.time, record_.steps,
                      fmt::format("front {:.2f} m, {:.2f} m/s", row.robust_front, row.rms_speed));
    }
    if (frame_due) frames_.write(particle_set<Dim>(scene_, solver_->particles(), record_.time));
    record_.output_seconds += seconds_since(since);
    if (!series_due || record_.time < shaking_end) return false;
    if (front_.at_rest(scene_.rest))
      record_.stop_reason = "at rest";
    else if (front_.flow_is_over(scene_.rest))
      record_.stop_reason = "flow over";
    return !record_.stop_reason.empty();
  }

  void mind_checkpoints() {
    if (!solver_->resumable()) return;
    const std::string reason = control_.interruption ? control_.interruption(record_.steps) : "";
    if (!reason.empty()) {
      save();
      throw InterruptedError(fmt::format("interrupted by {}; to go on: {}", reason, control_.resume_command));
    }
    if (scene_.checkpoint_interval > 0.0 && seconds_since(last_checkpoint_) > 60.0 * scene_.checkpoint_interval) save();
  }

  std::string last_good_state() const {
    std::string text;
    if (frames_.count() > 0) text += "; last frame: " + (folder_ / "frames" / frames_.last()).string();
    if (std::filesystem::exists(checkpoint_)) text += "; last checkpoint: " + checkpoint_.string();
    return text;
  }

  void finish() {
    frames_.wait();
    record_.frames = frames_.count();
    record_.wall_seconds = wall_seconds_before_ + seconds_since(start_);
    front_.write(folder_ / "front.csv");
    ledger_.write(folder_ / "ledger.csv");
    bodies_.write(folder_ / "bodies.csv");
    sections_.write(folder_ / "sections.csv");
    auto summary = make_summary<Dim>(scene_, *solver_, record_, ledger_, front_);
    if (sections_.any()) summary["sections"] = sections_.summary();
    write_text_file((folder_ / "summary.json").string(), text_of_json(summary, 2) + "\n");
  }

  const Clock::time_point start_ = Clock::now();
  const Scene& scene_;
  std::filesystem::path folder_, checkpoint_;
  const Provenance& provenance_;
  const RunControl& control_;
  std::array<double, Dim> gravity_;
  std::unique_ptr<Solver<Dim>> solver_;
  RunRecord record_;
  Schedule series_{scene_.output.series_interval, 0}, frame_{scene_.output.frame_interval, 0};
  Ledger<Dim> ledger_;
  EnergyWatch watch_;
  FrontSeries<Dim> front_;
  BodySeries<Dim> bodies_;
  SectionSeries sections_;
  FrameWriter frames_;
  Clock::time_point last_checkpoint_ = start_;
  double wall_seconds_before_ = 0.0;
};

}  // namespace

template <int Dim>
void run_scene(const Scene& scene, const std::filesystem::path& folder, const Provenance& provenance,
               const RunControl& control) {
  Runout<Dim>(scene, folder, provenance, control).run();
}

template void run_scene<2>(const Scene&, const std::filesystem::path&, const Provenance&, const RunControl&);
template void run_scene<3>(const Scene&, const std::filesystem::path&, const Provenance&, const RunControl&);

}  // namespace tailrun::mpm

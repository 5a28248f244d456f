// mpm_stage: large deformation of a liquefied dam by the explicit material point method.
//
//   d rho / dt = -rho div v,    rho dv/dt = div s + rho (g - a_base),    ds/dt = C : (D - D_plastic) + rotation
//
// Particles carry mass, momentum and stress; a background grid of B-splines solves the momentum balance of each step:
//   m_i = sum_p w_ip m_p,   (m v)_i = sum_p w_ip m_p (v_p + C_p (x_i - x_p)),   f_i = -sum_p V_p s_p grad w_ip
//   v_i* = v_i + dt (f_i / m_i + g),  then walls and ground (Coulomb),  then v_p = sum w v_i*,  x_p += dt v_p
//
//   mpm_stage run cases/mochikoshi/mpm.json -o out/mochikoshi/mpm --particles out/mochikoshi/particles.h5
//   mpm_stage run cases/verification/mu_block/mpm.json -o out/mu_block
//
// The folder given with -o gets frames/ (particles files for ParaView and an index), front.csv, ledger.csv and
// summary.json. Exit status: 0 done, 1 bad input, 2 the computation failed (the last good state is on disk).
#include <spdlog/spdlog.h>

#include <chrono>

#include "common/application.hpp"
#include "common/error.hpp"
#include "common/progress.hpp"
#include "mpm_stage/output/frames.hpp"
#include "mpm_stage/output/front.hpp"
#include "mpm_stage/output/ledger.hpp"
#include "mpm_stage/output/summary.hpp"
#include "mpm_stage/scene/scene.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

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
  return b;
}

// The times at which something has to be recorded: multiples of an interval.
class Schedule {
 public:
  explicit Schedule(double interval) : interval_(interval) {}
  double next() const { return interval_ > 0.0 ? static_cast<double>(count_) * interval_ : 1e300; }
  bool due(double time) const { return time >= next() * (1.0 - 1e-12) - 1e-12; }
  void advance() { ++count_; }

 private:
  double interval_;
  long count_ = 0;
};

template <int Dim>
void run(const Scene& scene, const std::filesystem::path& folder, const Provenance& provenance) {
  const auto start = Clock::now();
  RunRecord record;
  const auto gravity = in_dimension<Dim>(scene.gravity);

  // 1. The solver for this scene's dimension, shape functions, transfer and materials, with its particles on the grid.
  const auto solver =
      make_solver<Dim>(scene.solver, scene.cell_size, in_dimension<Dim>(scene.origin), solver_particles<Dim>(scene),
                       scene.materials, scene.terrain, in_dimension<Dim>(scene.walls));
  Schedule series(scene.output.series_interval), frames(scene.output.frame_interval);
  const auto until_next_event = [&](double time) {
    const double next = std::min({series.next(), frames.next(), scene.end_time});
    return next > time ? next - time : 1e300;
  };
  series.advance();
  frames.advance();
  solver->start(until_next_event(0.0));
  record.first_unbalanced = solver->unbalanced_force_ratio(gravity);

  // 2. Records of the start.
  Ledger<Dim> ledger(gravity);
  FrontSeries<Dim> front(scene);
  FrameWriter writer(folder / "frames", provenance);
  ledger.sample(0.0, *solver, scene.energy_growth_limit);
  front.sample(0.0, solver->particles());
  if (scene.output.frame_interval > 0.0) writer.write(particle_set<Dim>(scene, solver->particles(), 0.0));
  record.setup_seconds = seconds_since(start);
  spdlog::info(
      "{} particles in {} blocks of {} cells, first time step {:.3g} s, out-of-balance forces {:.3g} of the weight",
      solver->particles().count(), solver->grid().occupied(), Block<Dim>::nodes, solver->next_dt(),
      record.first_unbalanced);

  // 3. Step until the end or until all is at rest.
  Progress progress("mpm", scene.end_time, "s");
  const double shaking_end = scene.base.shaken() ? scene.base.motion->duration() - scene.base.start : 0.0;
  const auto finish = [&] {
    writer.wait();
    record.frames = writer.count();
    record.wall_seconds = seconds_since(start);
    front.write(folder / "front.csv");
    ledger.write(folder / "ledger.csv");
    write_text_file((folder / "summary.json").string(),
                    make_summary<Dim>(scene, *solver, record, ledger, front).dump(2) + "\n");
  };
  try {
    while (record.time < scene.end_time * (1.0 - 1e-12)) {
      std::array<double, Dim> inertial{};
      if (scene.base.shaken()) {
        const double a = scene.base.motion->acceleration_at(scene.base.start + record.time + 0.5 * solver->next_dt());
        for (int d = 0; d < Dim; ++d) inertial[d] = -a * scene.base.direction[d];
      }
      // An event that falls on the end of this step is over by the next one.
      const double after = record.time + solver->next_dt();
      const bool series_due = series.due(after), frame_due = frames.due(after);
      if (series_due) series.advance();
      if (frame_due) frames.advance();
      const StepReport report = solver->step(gravity, inertial, until_next_event(after));
      record.time = after;
      ++record.steps;
      record.particle_steps += static_cast<double>(solver->particles().count());
      record.dt_min = std::min(record.dt_min, report.dt);
      record.dt_max = std::max(record.dt_max, report.dt);
      record.largest_kinetic = std::max(record.largest_kinetic, report.kinetic_energy);
      if (!series_due && !frame_due) continue;

      const auto output_start = Clock::now();
      if (series_due) {
        ledger.sample(record.time, *solver, scene.energy_growth_limit);
        const FrontRow& row = front.sample(record.time, solver->particles());
        progress.update(record.time, record.steps,
                        fmt::format("front {:.2f} m, {:.2f} m/s", row.robust_front, row.rms_speed));
      }
      if (frame_due) writer.write(particle_set<Dim>(scene, solver->particles(), record.time));
      record.output_seconds += seconds_since(output_start);
      if (series_due && record.time >= shaking_end && front.at_rest(scene.rest)) {
        record.stop_reason = "at rest";
        break;
      }
    }
  } catch (const ComputationError& error) {
    // The frames so far are the last good state; the records up to here are kept beside them.
    record.stop_reason = fmt::format("failed at t = {:.6g} s: {}", record.time, error.what());
    finish();
    throw ComputationError(
        fmt::format("t = {:.6g} s: {}{}", record.time, error.what(),
                    writer.count() > 0 ? "; last good state: " + (folder / "frames" / writer.last()).string() : ""));
  }
  if (record.stop_reason.empty()) record.stop_reason = "end time";

  // 4. The last state and the summary.
  if (scene.output.frame_interval > 0.0) writer.write(particle_set<Dim>(scene, solver->particles(), record.time));
  progress.finish(record.stop_reason);
  if (ledger.rows().back().time < record.time) {
    ledger.sample(record.time, *solver, scene.energy_growth_limit);
    front.sample(record.time, solver->particles());
  }
  finish();
  const auto& f = front.rows();
  fmt::print("{}: {} after {:.3f} s, {} steps; front {:.3f} m -> {:.3f} m; energy residual {:.2e} of {:.4g} J\n",
             scene.title, record.stop_reason, record.time, record.steps, f.front().robust_front, f.back().robust_front,
             ledger.rows().back().residual / std::max(ledger.turnover(), 1e-300), ledger.turnover());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runout of liquefied soil by the material point method", "mpm_stage"};
  add_common_options(app);
  std::filesystem::path case_path, output, particles;
  std::string size;
  CLI::App* command = app.add_subcommand("run", "Run a case file (mpm.json)");
  command->add_option("case", case_path, "case file (JSON)")->required();
  command->add_option("-o,--output", output, "folder for the results")->required();
  command->add_option("--particles", particles, "particles file, in place of the case file's particles_file");
  command->add_option("--size", size, "entry of /sizes in the case (coarse, default, fine): its cell size");
  command->callback([&] {
    const CaseFile file(case_path);
    const Scene scene = read_scene(file, particles, size);
    file.finish();
    echo_options(case_path.string(), file.echo());
    Provenance provenance;
    provenance.program = "mpm_stage";
    provenance.add_text(case_path, file.text());
    for (const auto& input : scene.inputs) provenance.add_file(input);
    if (scene.dimension == 2)
      run<2>(scene, output, provenance);
    else
      run<3>(scene, output, provenance);
  });
  app.require_subcommand(1);
  return run_application(app, argc, argv);
}

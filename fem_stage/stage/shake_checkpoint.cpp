#include "fem_stage/stage/shake_checkpoint.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "common/file_format.hpp"
#include "common/same_inputs.hpp"

namespace tailrun::fem {
namespace {

const char* const format_name = "fem_shake_checkpoint";
const std::string run = "/run/", kept = "/state/";
constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Calls action(name, values, length, optional) for every array of the state as it is between two steps.
template <class AnyState, class Action>
void for_each_array(AnyState& state, std::size_t nodes, std::size_t elements, Action action) {
  action("displacement", state.displacement, 2 * nodes, false);
  action("velocity", state.velocity, 2 * nodes, false);
  action("acceleration", state.acceleration, 2 * nodes, false);
  action("pressure", state.pressure, nodes, false);
  action("pressure_rate", state.pressure_rate, nodes, false);
  action("stress", state.stress, 4 * elements, false);
  action("hourglass_force", state.hourglass_force, 2 * elements, false);
  action("held_force", state.held_force, 2 * nodes, false);
  action("initial_stress", state.initial_stress, 4 * elements, false);
  action("initial_pressure", state.initial_pressure, nodes, false);
  action("max_pore_pressure_ratio", state.max_pore_pressure_ratio, elements, false);
  action("rotation", state.rotation, elements, true);
  action("turned_hourglass_force", state.turned_hourglass_force, 2 * elements, true);
  action("floor_stress", state.floor_stress, 2 * elements, true);
  action("liquefied", state.liquefied, elements, true);
  action("softening", state.softening, elements, true);
}

// Single numbers, in one order for writing and reading.
template <class AnyProgress, class Action>
void for_each_number(AnyProgress& p, Action action) {
  for (auto* x : {&p.ledger.external_work, &p.ledger.kinetic_energy, &p.ledger.skeleton_work, &p.ledger.fluid_work,
                  &p.ledger.hourglass_work, &p.ledger.damping_work, &p.ledger.dashpot_work, &p.matrix.scale,
                  &p.matrix.step, &p.next_record, &p.next_regular, &p.wall_seconds, &p.output_seconds,
                  &p.material_seconds, &p.counts.assembly_seconds, &p.counts.factorisation_seconds,
                  &p.counts.solve_seconds, &p.counts.element_seconds})
    action(*x);
}

template <class AnyCounts, class Action>
void for_each_count(AnyCounts& c, Action action) {
  for (auto* x : {&c.steps, &c.iterations, &c.factorisations, &c.solves, &c.halvings, &c.material_substeps}) action(*x);
}

template <class Action>
void for_each_value(QualityRow& r, Action action) {
  for (double* x : {&r.time, &r.largest_displacement, &r.smallest_jacobian, &r.jacobian_kept, &r.liquefied_depth,
                    &r.mean_ratio, &r.liquefied_share})
    action(*x);
}
constexpr std::size_t quality_width = 8;

}  // namespace

void write_shake_checkpoint(const std::filesystem::path& path, const Model& model, const State& state,
                            const MaterialPoints& points, const ShakeProgress& progress) {
  Hdf5Writer file(path);
  write_format(file, format_name, shake_checkpoint_version);
  write_provenance(file, model.options->provenance);
  file.attribute("/tailrun", "time_s", state.time);
  file.attribute("/tailrun", "rigid_displacement_m", state.rigid_displacement);
  const auto put = [&](const std::string& name, std::span<const double> values, std::size_t columns = 0) {
    file.write(name, values, columns, "1", "SI units");
  };
  for_each_array(
      state, model.nodes(), model.count(),
      [&](const char* name, const std::vector<double>& values, std::size_t, bool) { put(kept + name, values); });
  put(kept + "material", points.save_state());

  std::vector<double> numbers, rows;
  for_each_number(progress, [&](double x) { numbers.push_back(x); });
  put(run + "numbers", numbers);
  const double since[2] = {progress.energy_open_since.value_or(none), progress.hourglass_since.value_or(none)};
  put(run + "since", since);
  std::vector<std::int64_t> counts;
  for_each_count(progress.counts, [&](long x) { counts.push_back(x); });
  counts.push_back(progress.matrix.last_iterations);
  counts.push_back(static_cast<std::int64_t>(progress.next_snapshot));
  file.write(run + "counts", std::span<const std::int64_t>(counts), 0, "1",
             "counts of the solver, iterations of the last step, next snapshot");
  put(run + "matrix_bulk", progress.matrix.basis.bulk);
  put(run + "matrix_shear", progress.matrix.basis.shear);
  put(run + "matrix_mobility", progress.matrix.basis.mobility);
  put(run + "matrix_displacement", progress.matrix.basis.displacement);
  put(run + "hourglass_work", progress.hourglass_work);
  put(run + "last_load", progress.last_load);
  put(run + "free_field", progress.free_field);
  for (QualityRow row : progress.quality) {
    for_each_value(row, [&](double x) { rows.push_back(x); });
    rows.push_back(row.inverted);
  }
  put(run + "quality", rows, quality_width);
  file.write_texts(run + "history_lines", progress.history_lines, "rows of history.csv");
  file.write_texts(run + "quality_lines", progress.quality_lines, "rows of quality.csv");
  file.write_texts(run + "snapshots", progress.snapshots, "snapshots written so far");
  put(run + "snapshot_times", progress.snapshot_times);
  file.commit();
}

ShakeProgress read_shake_checkpoint(const std::filesystem::path& path, const Model& model, State& state,
                                    MaterialPoints& points) {
  if (!std::filesystem::exists(path))
    throw InputError(fmt::format(
        "{}: no such file, so there is nothing to go on from: the run has not begun or has reached its end. "
        "Run it without --resume",
        path.string()));
  const Hdf5Reader file(path);
  check_format(file, format_name, shake_checkpoint_version);
  check_same_inputs(file, model.options->provenance);
  state.time = file.number_attribute("/tailrun", "time_s");
  state.rigid_displacement = file.number_attribute("/tailrun", "rigid_displacement_m");
  if (!(state.time >= 0.0 && state.time <= model.options->shake.duration))
    file.fail("/tailrun", fmt::format("time_s is {:g}, but the shaking lasts from 0 to {:g} s", state.time,
                                      model.options->shake.duration));
  for_each_array(state, model.nodes(), model.count(),
                 [&](const char* name, std::vector<double>& values, std::size_t length, bool optional) {
                   const bool left_out = optional && file.shape(kept + name)[0] == 0;
                   values = left_out ? std::vector<double>() : file.doubles(kept + name, length, 1);
                 });
  points.restore_state(file.doubles(kept + "material", points.save_state().size(), 1));

  ShakeProgress progress;
  std::size_t count = 0;
  for_each_number(progress, [&](double&) { ++count; });
  const auto numbers = file.doubles(run + "numbers", count, 1);
  std::size_t k = 0;
  for_each_number(progress, [&](double& x) { x = numbers[k++]; });
  const auto since = file.doubles_or_gaps(run + "since", 2, 1);
  if (!std::isnan(since[0])) progress.energy_open_since = since[0];
  if (!std::isnan(since[1])) progress.hourglass_since = since[1];
  count = 2;
  for_each_count(progress.counts, [&](long&) { ++count; });
  const auto counts = file.integers(run + "counts", count, 1);
  k = 0;
  for_each_count(progress.counts, [&](long& x) { x = counts[k++]; });
  check_indices(file, run + "counts", counts, 0, std::numeric_limits<std::int64_t>::max());
  progress.matrix.last_iterations = static_cast<int>(std::min<std::int64_t>(counts[k++], 1000));
  if (progress.matrix.step > 0.0) {
    MatrixBasis& basis = progress.matrix.basis;
    basis.bulk = file.doubles(run + "matrix_bulk", model.count(), 1);
    basis.shear = file.doubles(run + "matrix_shear", model.count(), 1);
    basis.mobility = file.doubles(run + "matrix_mobility", model.count(), 1);
    if (model.options->shake.large_displacement)
      basis.displacement = file.doubles(run + "matrix_displacement", 2 * model.nodes(), 1);
  }
  progress.next_snapshot = std::min(static_cast<std::size_t>(counts[k]), model.options->output.snapshots.size());
  progress.hourglass_work = file.doubles(run + "hourglass_work", model.count(), 1);
  progress.last_load = file.doubles(run + "last_load", 2 * model.nodes(), 1);
  progress.free_field = file.doubles(run + "free_field");
  const auto rows = file.doubles(run + "quality", 0, quality_width);
  for (std::size_t i = 0; i < rows.size(); i += quality_width) {
    QualityRow row{};
    std::size_t j = i;
    for_each_value(row, [&](double& x) { x = rows[j++]; });
    row.inverted = static_cast<int>(std::clamp(rows[j], 0.0, 1e9));
    progress.quality.push_back(row);
  }
  progress.history_lines = file.texts(run + "history_lines");
  progress.quality_lines = file.texts(run + "quality_lines");
  progress.snapshots = file.texts(run + "snapshots");
  progress.snapshot_times = file.doubles(run + "snapshot_times", 0, 1);
  if (progress.snapshots.size() != progress.snapshot_times.size())
    file.fail(run + "snapshot_times", "has another number of rows than the names of the snapshots");
  for (const auto& name : progress.snapshots)
    if (std::filesystem::path(name).filename() != name)
      file.fail(run + "snapshots", fmt::format("'{}' is no plain file name", name));
  return progress;
}

}  // namespace tailrun::fem

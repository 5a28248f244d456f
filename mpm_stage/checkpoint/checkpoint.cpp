#include "mpm_stage/checkpoint/checkpoint.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "common/error.hpp"
#include "common/file_format.hpp"
#include "common/same_inputs.hpp"
#include "mpm_stage/checkpoint/checkpoint_checks.hpp"

namespace tailrun::mpm {

namespace {

const char* const format_name = "mpm_checkpoint";
constexpr std::size_t pond_numbers = 6;                      // of a PondState
constexpr std::int64_t block_range = std::int64_t{1} << 20;  // of the grid's keys

// Calls action(name, unit, column) for all columns that the next step reads; it writes the gradients before it does.
template <class P, class Action>
void for_each_kept_column(P& particles, Action action) {
  const auto family = [&](const std::string& name, const char* unit, auto& columns) {
    for (std::size_t k = 0; k < columns.size(); ++k) action(fmt::format("{}_{}", name, k), unit, columns[k]);
  };
  family("position", "m", particles.position);
  family("velocity", "m/s", particles.velocity);
  family("affine", "1/s", particles.affine);
  family("stress", "Pa", particles.stress);
  action(std::string("mass"), "kg", particles.mass);
  action(std::string("volume"), "m3", particles.volume);
  action(std::string("plastic_strain"), "1", particles.plastic_strain);
  action(std::string("strength"), "Pa", particles.strength);
  action(std::string("pore_pressure"), "Pa", particles.pore_pressure);
  action(std::string("rest_volume"), "m3", particles.rest_volume);
}

// Single numbers, each with its name: state of solver and run loop. Integers below 2^53 are exact as doubles.
template <int Dim, class Action>
void for_each_number(SolverState<Dim>& s, RunState& r, Action action) {
  const auto integer = [&](const char* name, long& value) {
    double number = static_cast<double>(value);
    action(name, number);
    value = static_cast<long>(number);
  };
  action("next_time_step", s.next_dt);
  action("viscous_limit", s.viscous_limit);
  action("drift", s.drift);
  action("fastest_wave", s.fastest_wave);
  action("kinetic", s.kinetic);
  integer("sorts", s.sorts);
  action("work_plastic", s.work.plastic);
  action("work_friction", s.work.friction);
  action("work_contact", s.work.contact);
  action("work_damping", s.work.damping);
  action("work_external", s.work.external);
  action("work_removed", s.work.removed);
  action("work_pore_pressure", s.work.pore_pressure);
  action("work_crowding", s.work.crowding);
  action("work_transfer", s.work.transfer);
  action("work_impact", s.work.impact);
  action("seconds_grid", s.seconds.grid);
  action("seconds_grid_to_particles", s.seconds.grid_to_particles);
  action("seconds_volumetric", s.seconds.volumetric);
  action("seconds_stress_and_scatter", s.seconds.stress_and_scatter);
  action("seconds_sort", s.seconds.sort);
  for (int d = 0; d < Dim; ++d) action(fmt::format("boundary_impulse_{}", d).c_str(), s.impulse[d]);
  action("solver_time", s.time);
  integer("steps", r.record.steps);
  action("particle_steps", r.record.particle_steps);
  action("asleep_particle_steps", r.record.asleep_particle_steps);
  action("time", r.record.time);
  action("shortest_step", r.record.dt_min);
  action("longest_step", r.record.dt_max);
  action("wall_seconds", r.record.wall_seconds);
  action("output_seconds", r.record.output_seconds);
  action("setup_seconds", r.record.setup_seconds);
  action("first_unbalanced", r.record.first_unbalanced);
  action("largest_kinetic_of_steps", r.record.largest_kinetic);
  action("largest_kinetic_of_rows", r.largest_kinetic);
  integer("series_count", r.series_count);
  integer("frame_count", r.frame_count);
}

// Rows of the series as plain numbers, for writing and for reading.
template <class Action>
void for_each_value(LedgerRow& r, Action action) {
  for (double* x : {&r.time,
                    &r.kinetic,
                    &r.elastic,
                    &r.gravitational,
                    &r.work.plastic,
                    &r.work.friction,
                    &r.work.contact,
                    &r.work.damping,
                    &r.work.external,
                    &r.work.removed,
                    &r.work.pore_pressure,
                    &r.work.crowding,
                    &r.work.transfer,
                    &r.work.impact,
                    &r.lost,
                    &r.residual,
                    &r.mass,
                    &r.momentum[0],
                    &r.momentum[1],
                    &r.momentum[2],
                    &r.angular_momentum})
    action(*x);
}

template <class Action>
void for_each_value(FrontRow& r, Action action) {
  for (double* x : {&r.time, &r.front, &r.robust_front, &r.flow_front, &r.flow_body, &r.coherent_front, &r.ground,
                    &r.flowed_mass, &r.top, &r.centre_x, &r.centre_y, &r.rms_speed, &r.maximum_speed})
    action(*x);
  for (double& x : r.points) action(x);
}

template <class Action>
void for_each_value(BodyRow& r, Action action) {
  action(r.time);
  for (double& x : r.values) action(x);
}

template <class Action>
void for_each_value(SectionRow& r, Action action) {
  action(r.time);
  for (SectionState& s : r.of)
    for (double* x : {&s.mass, &s.volume, &s.area, &s.discharge}) action(*x);
}

template <class Row>
void write_rows(Hdf5Writer& file, const std::string& name, std::vector<Row> rows) {
  std::vector<double> values;
  for (Row& row : rows) for_each_value(row, [&](double x) { values.push_back(x); });
  file.write(name, values, rows.empty() ? 1 : values.size() / rows.size(), "1", "rows of the series, SI units");
}

template <class Row>
std::vector<Row> read_rows(const Hdf5Reader& file, const std::string& name, const Row& like, bool gaps) {
  std::size_t width = 0;
  Row row = like;
  for_each_value(row, [&](double) { ++width; });
  const std::vector<double> values = gaps ? file.doubles_or_gaps(name, 0, width) : file.doubles(name, 0, width);
  std::vector<Row> rows(values.size() / width, like);
  std::size_t k = 0;
  for (Row& r : rows) for_each_value(r, [&](double& x) { x = values[k++]; });
  return rows;
}

}  // namespace

template <int Dim>
void write_checkpoint(const std::filesystem::path& path, Solver<Dim>& solver, double cell_size, RunState run,
                      const Provenance& provenance) {
  Hdf5Writer file(path);
  write_format(file, format_name, checkpoint_format_version);
  write_provenance(file, provenance);
  SolverState<Dim> state = solver.state();

  file.group("/numbers");
  file.attribute("/numbers", "dimension", static_cast<double>(Dim));
  file.attribute("/numbers", "cell_size", cell_size);
  file.attribute("/numbers", "grip_blocks", static_cast<double>(state.grip.blocks.size()));
  for_each_number(state, run, [&](const char* name, double value) { file.attribute("/numbers", name, value); });

  const Particles<Dim>& P = solver.particles();
  for_each_kept_column(P, [&](const std::string& name, const char* unit, const auto& column) {
    if (!column.empty())
      file.write("/particles/" + name, std::span<const double>(column.data(), column.size()), 0, unit,
                 "in the solver's order");
  });
  file.write("/particles/material", std::span<const std::int32_t>(P.material.data(), P.count()), 0, "1", "number");
  file.write("/particles/identity", std::span<const std::int32_t>(P.identity.data(), P.count()), 0, "1",
             "row of the input");

  if (!P.side.empty())
    file.write("/particles/side", std::span<const std::int32_t>(P.side.data(), P.count()), 0, "1",
               "1: above weak soil, in a velocity field of its own");

  std::vector<std::int64_t> blocks;
  for (const auto& index : state.blocks) blocks.insert(blocks.end(), index.begin(), index.end());
  const std::vector<std::int64_t> first(state.first.begin(), state.first.end());
  file.write("/grid/blocks", std::span<const std::int64_t>(blocks), Dim, "1", "occupied blocks at the last sort");
  file.write("/grid/first", std::span<const std::int64_t>(first), 0, "1", "first particle of each block, and the end");
  file.write("/grid/wave_speed", state.wave_speed, 0, "m/s", "by material");
  if (!state.grip.blocks.empty()) {
    std::vector<std::int64_t> gripping;
    for (const auto& index : state.grip.blocks) gripping.insert(gripping.end(), index.begin(), index.end());
    file.write("/grid/grip_blocks", std::span<const std::int64_t>(gripping), Dim, "1",
               "blocks in which material touches the ground or another field's");
    const std::vector<std::int64_t> fields(state.grip.fields.begin(), state.grip.fields.end());
    file.write("/grid/grip_fields", std::span<const std::int64_t>(fields), 0, "1",
               "velocity field of each, or 4 and more: pair of fields");
    file.write("/grid/grip", state.grip.smoothed, Block<Dim>::nodes, "m/s2",
               "smoothed friction per mass of their nodes");
  }
  file.write("/grid/meeting", std::span<const std::int32_t>(state.meeting), 0, "1",
             "nodes at which velocity fields met in the last step");
  file.write("/grid/sleep_clocks", state.sleep_clocks, 0, "s",
             "of each block: calm so far, or minus the rest of its nap");
  if (!state.ponds.empty()) {
    std::vector<double> ponds;
    for (const PondState& pond : state.ponds) {
      ponds.insert(ponds.end(), {pond.level, pond.mapped_level, pond.escaped});
      ponds.insert(ponds.end(), pond.place.begin(), pond.place.end());
    }
    file.write(
        "/grid/ponds", ponds, pond_numbers, "m, m, s, m",
        "of each pond: level, level at the last sort, since when its water could leave (negative: never), where");
    file.write("/grid/pond_shares", state.pond_shares, 0, "1",
               "share of the water's pressure at the nodes of the active blocks, pond after pond");
  }
  file.write("/particles/removed", std::span<const std::int32_t>(state.removed), 0, "1", "rows of the input");
  file.write("/particles/held", std::span<const std::int32_t>(state.held), 0, "1", "rows of the input");

  write_rows(file, "/series/ledger", std::move(run.ledger));
  write_rows(file, "/series/front", std::move(run.front));
  if (!state.bodies.empty()) {
    std::vector<double> bodies;
    for (const BodyState<Dim>& b : state.bodies) {
      bodies.insert(bodies.end(), b.displacement.begin(), b.displacement.end());
      bodies.insert(bodies.end(), b.impulse.begin(), b.impulse.end());
    }
    file.write("/series/body_state", bodies, 2 * Dim, "m, N s", "displacement and impulse of each moving body");
    write_rows(file, "/series/bodies", std::move(run.bodies));
  }
  if (!run.sections.empty()) write_rows(file, "/series/sections", std::move(run.sections));
  file.write_texts("/series/frame_names", run.frame_names, "frames written so far");
  file.write("/series/frame_times", run.frame_times, 0, "s", "their times");
  file.commit();
}

template <int Dim>
RunState read_checkpoint(const std::filesystem::path& path, Solver<Dim>& solver, const Scene& scene,
                         const Provenance& provenance) {
  const double cell_size = scene.cell_size;
  const Hdf5Reader file(path);
  check_format(file, format_name, checkpoint_format_version);
  check_same_inputs(file, provenance);
  if (file.number_attribute("/numbers", "dimension") != Dim ||
      file.number_attribute("/numbers", "cell_size") != cell_size)
    file.fail("/numbers", fmt::format("holds a run in {} dimensions with cells of {} m, and this one has {} and {} m "
                                      "(--size must be the same)",
                                      file.number_attribute("/numbers", "dimension"),
                                      file.number_attribute("/numbers", "cell_size"), Dim, cell_size));
  SolverState<Dim> state;
  RunState run;
  for_each_number(state, run, [&](const char* name, double& value) {
    // With FMPM what transfers and impacts cost is not known.
    const std::string_view word = name;
    value = word == "work_transfer" || word == "work_impact" ? file.number_attribute_or_gap("/numbers", name)
                                                             : file.number_attribute("/numbers", name);
  });
  for (const char* name : {"sorts", "steps", "series_count", "frame_count"}) whole_attribute(file, "/numbers", name);

  // The solver's own particles say which columns there are and how many materials.
  Particles<Dim>& like = solver.particles();
  const auto materials = file.integers("/particles/material", 0, 1);
  const std::size_t n = materials.size();
  if (n == 0 || n > like.count())
    file.fail("/particles/material", fmt::format("has {} rows, but the input has {} particles", n, like.count()));
  const auto identities = file.integers("/particles/identity", n, 1);
  check_indices(file, "/particles/identity", identities, 0, static_cast<std::int64_t>(like.count()));
  check_indices(file, "/particles/material", materials, 0, static_cast<std::int64_t>(scene.materials.size()));
  Particles<Dim> P;
  P.resize(n, !like.affine[0].empty(), !like.pore_pressure.empty(), !like.rest_volume.empty());
  for_each_kept_column(P, [&](const std::string& name, const char*, auto& column) {
    if (column.empty()) return;
    const auto values = file.doubles("/particles/" + name, n, 1);
    std::copy(values.begin(), values.end(), column.begin());
  });
  std::copy(materials.begin(), materials.end(), P.material.begin());
  std::copy(identities.begin(), identities.end(), P.identity.begin());
  if (!like.side.empty()) {
    const auto sides = file.integers("/particles/side", n, 1);
    check_indices(file, "/particles/side", sides, 0, 2);
    P.side.assign(sides.begin(), sides.end());
  }

  const auto blocks = file.integers("/grid/blocks", 0, Dim);
  const auto first = file.integers("/grid/first", blocks.size() / Dim + 1, 1);
  if (first.front() != 0 || first.back() != static_cast<std::int64_t>(n) || !std::is_sorted(first.begin(), first.end()))
    file.fail("/grid/first", fmt::format("must rise from 0 to the number of particles, {}", n));
  state.blocks.resize(blocks.size() / Dim);
  check_indices(file, "/grid/blocks", blocks, -block_range, block_range);
  for (std::size_t k = 0; k < blocks.size(); ++k) state.blocks[k / Dim][k % Dim] = static_cast<int>(blocks[k]);
  state.first.assign(first.begin(), first.end());
  const auto gripping = static_cast<std::size_t>(whole_attribute(file, "/numbers", "grip_blocks"));
  if (gripping > 0) {
    const auto index = file.integers("/grid/grip_blocks", gripping, Dim);
    check_indices(file, "/grid/grip_blocks", index, -block_range, block_range);
    state.grip.blocks.resize(gripping);
    for (std::size_t k = 0; k < index.size(); ++k) state.grip.blocks[k / Dim][k % Dim] = static_cast<int>(index[k]);
    const auto fields = file.integers("/grid/grip_fields", gripping, 1);
    check_indices(file, "/grid/grip_fields", fields, 0, most_fields + pairs_of(most_fields));
    state.grip.fields.assign(fields.begin(), fields.end());
    state.grip.smoothed = file.doubles("/grid/grip", gripping, Block<Dim>::nodes);
  }
  state.wave_speed = file.doubles("/grid/wave_speed", 0, 1);
  const auto meeting = file.integers("/grid/meeting", 0, 1);
  check_indices(file, "/grid/meeting", meeting, 0, 2);
  state.meeting.assign(meeting.begin(), meeting.end());
  state.sleep_clocks = file.doubles("/grid/sleep_clocks", 0, 1);
  if (!scene.solver.ponds.empty()) {
    const auto ponds = file.doubles("/grid/ponds", scene.solver.ponds.size(), pond_numbers);
    for (std::size_t k = 0; k < ponds.size(); k += pond_numbers)
      state.ponds.push_back({ponds[k], ponds[k + 1], ponds[k + 2], {ponds[k + 3], ponds[k + 4], ponds[k + 5]}});
    state.pond_shares = file.doubles("/grid/pond_shares", 0, 1);
  }
  const auto removed = file.integers("/particles/removed", 0, 1), held = file.integers("/particles/held", 0, 1);
  check_indices(file, "/particles/removed", removed, 0, static_cast<std::int64_t>(like.count()));
  state.removed.assign(removed.begin(), removed.end());
  check_indices(file, "/particles/held", held, 0, static_cast<std::int64_t>(like.count()));
  state.held.assign(held.begin(), held.end());

  run.ledger = read_rows(file, "/series/ledger", LedgerRow{}, true);
  const auto shape = file.shape("/series/front");
  FrontRow row;
  std::size_t plain = 0;
  for_each_value(row, [&](double) { ++plain; });
  if (shape.size() != 2 || shape[1] < plain || (shape[1] - plain) % 2 != 0)
    file.fail("/series/front", "has too few columns");
  row.points.resize(shape[1] - plain);
  run.front = read_rows(file, "/series/front", row, true);
  state.bodies = solver.bodies();
  if (!state.bodies.empty()) {
    const auto bodies = file.doubles("/series/body_state", state.bodies.size(), 2 * Dim);
    for (std::size_t b = 0; b < state.bodies.size(); ++b)
      for (std::size_t d = 0; d < Dim; ++d) {
        state.bodies[b].displacement[d] = bodies[2 * Dim * b + d];
        state.bodies[b].impulse[d] = bodies[2 * Dim * b + Dim + d];
      }
    BodyRow body_row;
    body_row.values.resize(2 * Dim * state.bodies.size());
    run.bodies = read_rows(file, "/series/bodies", body_row, false);
  }
  if (!scene.output.sections.empty()) {
    SectionRow section_row;
    section_row.of.resize(scene.output.sections.size());
    run.sections = read_rows(file, "/series/sections", section_row, false);
  }
  run.frame_names = file.texts("/series/frame_names");
  run.frame_times = file.doubles("/series/frame_times", 0, 1);
  if (run.frame_times.size() != run.frame_names.size())
    file.fail("/series/frame_times", fmt::format("has {} rows, but there are {} names of frames",
                                                 run.frame_times.size(), run.frame_names.size()));
  check_particles<Dim>(file, P, like, state.removed);
  check_blocks<Dim>(file, state, P, scene, solver.grid().origin());
  check_state<Dim>(file, state, scene);
  check_series(file, run, scene);
  solver.resume(std::move(P), state);
  return run;
}

template void write_checkpoint<2>(const std::filesystem::path&, Solver<2>&, double, RunState, const Provenance&);
template void write_checkpoint<3>(const std::filesystem::path&, Solver<3>&, double, RunState, const Provenance&);
template RunState read_checkpoint<2>(const std::filesystem::path&, Solver<2>&, const Scene&, const Provenance&);
template RunState read_checkpoint<3>(const std::filesystem::path&, Solver<3>&, const Scene&, const Provenance&);

}  // namespace tailrun::mpm

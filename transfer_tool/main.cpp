// transfer_tool: hands the state of the finite elements over to the particles.
//
//   sample   points in every kept element; mass = density x weight x |J0|, volume = weight x |J|
//   map      nodal fields by shape functions, stresses by element (or recovered inside a region)
//   assign   ordered rules give each point its material and its residual strength
//   audit    mass, volume, centre of mass and momentum of the particles are the mesh's own
//   write    the particles file
//
// Sample runs:
//   transfer_tool run transfer.json --snapshot snapshot_t16.000.h5 -o particles.h5
//   transfer_tool info particles.h5
//   transfer_tool import import.json -o snapshot.h5
//   transfer_tool strength transfer.json -o strength.csv
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

#include "common/application.hpp"
#include "common/case_settings.hpp"
#include "common/command_line.hpp"
#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "common/json_text.hpp"
#include "common/log.hpp"
#include "common/output_place.hpp"
#include "common/patient_threads.hpp"
#include "common/plausible_state.hpp"
#include "common/warnings.hpp"
#include "transfer_tool/assign/strength_table.hpp"
#include "transfer_tool/audit/audit.hpp"
#include "transfer_tool/audit/particle_set.hpp"
#include "transfer_tool/balance/equilibrate.hpp"
#include "transfer_tool/import/import_tables.hpp"
#include "transfer_tool/import/motion_and_rest.hpp"
#include "transfer_tool/inspect/file_report.hpp"
#include "transfer_tool/options/transfer_case.hpp"
#include "transfer_tool/sample/pond_reach.hpp"
#include "transfer_tool/sample/request_checks.hpp"

namespace {

using namespace tailrun;
using namespace tailrun::transfer;

struct RunOptions {
  std::string case_path, snapshot_path, geostatic_path, output_path, size;
};

std::filesystem::path options_of(const std::filesystem::path& output) {
  return output.parent_path() / (output.stem().string() + ".options.txt");
}

Snapshot read_state(const RunOptions& options, Provenance& provenance) {
  Snapshot snapshot = read_snapshot(options.snapshot_path);
  provenance.add_file(options.snapshot_path);
  if (!options.geostatic_path.empty()) {
    take_initial_state(snapshot, read_snapshot(options.geostatic_path));
    provenance.add_file(options.geostatic_path);
  }
  return snapshot;
}

void warn_about(const Snapshot& snapshot, const TransferCase& wanted, const std::vector<bool>& kept,
                const SamplePoints& points) {
  if (wanted.transfer_time && std::abs(*wanted.transfer_time - snapshot.time) > 1e-3)
    add_warning(fmt::format("the case wants the state at {:g} s, the snapshot is of {:g} s", *wanted.transfer_time,
                            snapshot.time));
  if (points.capped_elements > 0)
    add_warning(fmt::format(
        "{} elements want more than 5 Gauss points along a side for cells of {:g} m: take \"layout\": \"uniform\"",
        points.capped_elements, wanted.sampling.cell_size));
  for (std::size_t e = 0; e < snapshot.elements(); ++e)
    if (kept[e] && snapshot.thickness[e] != 1.0) {
      add_warning(
          fmt::format("region '{}' has a thickness of {:g} m; its particles are per metre of thickness all the same",
                      snapshot.region_names[static_cast<std::size_t>(snapshot.region_id[e])], snapshot.thickness[e]));
      break;
    }
}

// Stresses in balance on the runout's grid, said and recorded.
void put_in_balance(const CaseFile& file, double cell_size, double gravity, ParticleSet& particles) {
  if (!particles.ponds.empty())
    file.root().object_or_empty("state").fail(
        "equilibrate",
        "is for dams without ponds: the weight of standing water on the soil is no part of this balance");
  const Balance balance = equilibrate(particles, cell_size, gravity);
  log_info(
      "stresses changed by {:.3g} kPa (root mean square): forces out of balance on cells of {:g} m {:.2g} of the "
      "weight, {:.2g} before",
      balance.change / 1e3, cell_size, balance.after, balance.before);
  particles.notes["balance"] = text_of_json(nlohmann::ordered_json{{"cell_size_m", cell_size},
                                                                   {"nodes", balance.nodes},
                                                                   {"out_of_balance_before", balance.before},
                                                                   {"out_of_balance", balance.after},
                                                                   {"rms_stress_change_Pa", balance.change}},
                                            1);
}

void hand_over(const RunOptions& options) {
  check_output_file(options.output_path, {options.case_path, options.snapshot_path, options.geostatic_path});
  Provenance provenance{"transfer_tool", {}, {}};
  const CaseFile file(options.case_path);
  provenance.add_text(file.path(), file.text());
  const Snapshot snapshot = read_state(options, provenance);
  for (const auto& input : provenance.inputs) require_no_input(options_of(options.output_path), input);
  const TransferCase wanted = read_transfer_case(file, snapshot.region_names, options.size);
  const std::string title = "transfer_tool run " + options.case_path;
  const std::filesystem::path all = options_of(options.output_path);
  echo_options(title, file.echo(), all);

  // 1. Sample
  const std::vector<bool> kept = kept_elements(snapshot, wanted.sampling);
  check_request(file, options.size, snapshot, kept, wanted.sampling, options.output_path);
  stop_if_told("the sampling");
  const SamplePoints points = sample(snapshot, kept, wanted.sampling);
  warn_about(snapshot, wanted, kept, points);
  // Before stresses are weighed: water that is not there would be the reason for what they lack.
  const std::vector<PondedReach> ponds = pond_reaches(snapshot);
  check_standing_water(snapshot, kept, ponds);
  check_state(columns_of(snapshot, options.snapshot_path, kept, true));

  // 2. Map
  stop_if_told("the mapping");
  const PointState state = map_state(snapshot, points, wanted.state);

  // 3. Assign
  stop_if_told("the rules");
  const Assignment assignment = assign(snapshot, points, state, wanted.rules);
  for (const auto& warning : assignment.warnings) add_warning(warning);
  ParticleSet particles = particle_set(snapshot, points, state, assignment);
  if (wanted.terrain.any()) particles.terrain = terrain_lines(snapshot, kept, wanted.terrain);
  if (wanted.terrain.walls)
    for (auto& line : wall_lines(snapshot, kept, wanted.terrain)) particles.terrain.push_back(std::move(line));
  particles.ponds = ponds;
  stop_if_told("the balance");
  if (wanted.state.equilibrate) put_in_balance(file, wanted.sampling.cell_size, snapshot.gravity, particles);

  // 4. Audit
  stop_if_told("the audit");
  const Audit result = audit(
      snapshot, kept, wanted.state.remove_base_motion ? snapshot.base_velocity : std::array<double, 2>{}, particles);
  require_conserved(result);
  if (!quiet())
    fmt::print("{} particles at t = {:g} s, {:.3g} m apart on average\n\n{}", particles.count(), particles.time,
               particles.particle_size, audit_table(result));

  // 5. Write
  stop_if_told("the writing");
  particles.notes["audit"] = text_of_json(audit_json(result), 1);
  particles.notes["assignment"] = text_of_json(assignment.record, 1);
  if (!warnings().empty()) particles.notes["warnings"] = text_of_json(nlohmann::ordered_json(warnings()), 1);
  write_particles(options.output_path, particles, provenance);
  write_options(all, title, file.echo());
  log_info("wrote {}", options.output_path);
}

// What is wrong with a key only against the mesh is said with the key; here the file comes to it.
void run(const RunOptions& options) {
  try {
    hand_over(options);
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* root : {"/exclude", "/terrain", "/rules"})
      if (text.starts_with(root)) throw InputError(options.case_path + ": " + text);
    throw;
  }
}

void import(const std::string& case_path, const std::string& output_path) {
  check_output_file(output_path, {case_path});
  Provenance provenance{"transfer_tool", {}, {}};
  const CaseFile file(case_path);
  const Snapshot snapshot = import_tables(file, provenance);
  stop_if_told("the checks");
  for (const auto& input : provenance.inputs) {
    require_no_input(output_path, input);
    require_no_input(options_of(output_path), input);
  }
  check_standing_water(snapshot, std::vector<bool>(snapshot.elements(), true), pond_reaches(snapshot), true);
  check_state(columns_of(snapshot, case_path, {}, true));
  check_rest_and_motion(file.root(), snapshot);
  const std::string title = "transfer_tool import " + case_path;
  echo_options(title, file.echo(), options_of(output_path));
  stop_if_told("the writing");
  write_snapshot(output_path, snapshot, provenance);
  write_options(options_of(output_path), title, file.echo());
  if (!quiet())
    fmt::print("{} nodes, {} elements, {} regions at t = {:g} s: {}\n", snapshot.nodes(), snapshot.elements(),
               snapshot.region_names.size(), snapshot.time, output_path);
}

struct StrengthOptions {
  std::string case_path, output_path;
  std::vector<double> percentiles = {16, 33, 50, 84};  // %
  double highest = 400;                                // kPa, sigma'_v0
};

void strength(const StrengthOptions& options) {
  if (!options.output_path.empty()) check_output_file(options.output_path, {options.case_path});
  constexpr std::size_t points = 161;  // even steps of 2.5 kPa up to 400 kPa
  for (const double percentile : options.percentiles)
    if (percentile < 1.0)
      add_warning(fmt::format("--percentiles: {0:g} %, less than one in a hundred; a fraction of {0:g} is {1:g} %",
                              percentile, 100.0 * percentile));
  const CaseFile file(options.case_path);
  stop_if_told("the curves");
  const auto curves = strength_curves(file, options.percentiles);
  fmt::print("{}", strength_text(curves, 1e3 * options.highest));
  if (options.output_path.empty()) return;
  stop_if_told("the writing");
  write_text_file(options.output_path, strength_csv(curves, 1e3 * options.highest, points));
  log_info("wrote {}", options.output_path);
}

}  // namespace

int main(int argc, char** argv) {
  wait_patiently(argv);
  CommandLine line("Hands the finite elements' state over to the particles", "transfer_tool");
  constexpr auto required = SubCommand::Need::required;

  RunOptions options;
  SubCommand run_command = line.add_command("run", "Snapshot to particles");
  run_command.add("case", options.case_path, "transfer.json", required);
  run_command.add("--snapshot", options.snapshot_path, "Snapshot of fem_stage or of `import`", required);
  run_command.add("--geostatic", options.geostatic_path,
                  "Snapshot of the state before shaking, for sigma'_v0 and r_u (default: the snapshot's own record)");
  run_command.add("-o,--output", options.output_path, "Particles file to write", required);
  run_command.add("--size", options.size, "Entry of the case's \"sizes\", e.g. coarse");
  run_command.does([&] {
    note_signals();
    run(options);
  });

  std::string info_path;
  bool as_json = false;
  SubCommand info_command = line.add_command("info", "What is in a file of the chain");
  info_command.add("file", info_path, "Snapshot, particles, frame, geostatic or checkpoint file", required);
  info_command.add_flag("--json", as_json, "For machines");
  info_command.does([&] {
    if (!settings_in_use().empty()) throw InputError("--set: info reads no case file that it could change");
    const FileReport report = read_file_report(info_path);
    fmt::print("{}", as_json ? text_of_json(report_json(report), 1) + "\n" : report_text(report));
  });

  std::string import_path, snapshot_path;
  SubCommand import_command = line.add_command("import", "Another code's state, as CSV tables, to a snapshot");
  import_command.add("case", import_path, "import.json", required);
  import_command.add("-o,--output", snapshot_path, "Snapshot to write", required);
  import_command.does([&] {
    note_signals();
    import(import_path, snapshot_path);
  });

  StrengthOptions strength_options;
  SubCommand strength_command = line.add_command(
      "strength", "Residual strengths over sigma'_v0: the case's own, and other models for the same soil");
  strength_command.add("case", strength_options.case_path, "transfer.json", required);
  strength_command.add("-o,--output", strength_options.output_path,
                       "CSV to write (cases/plot/strength_plot.py draws it)");
  strength_command.add("--percentiles", strength_options.percentiles, "Of models that know them, in %: 16,33,50,84",
                       0.01, 99.99);
  strength_command.add("--stress-to", strength_options.highest, "Largest sigma'_v0, in kPa (400)", 1.0, 1e5);
  strength_command.does([&] {
    note_signals();
    strength(strength_options);
  });

  return line.run(argc, argv);
}

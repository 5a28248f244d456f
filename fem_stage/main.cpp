// fem_stage: shaking and liquefaction triggering of a dam, by finite elements, until the hand-over to the MPM stage.
//
//   div(sigma' - p I) + rho g = rho a                    momentum of the mixture
//   div(v) + (n / K_f) dp/dt + div(w) = 0, w = k'(-grad p + rho_f g)   mass of the water (u-p form, Zienkiewicz &
//   Shiomi 1984)
//
// on stabilised single-point quadrilaterals (SSPquadUP), with PM4Sand, a compliant base and free-field columns at the
// sides.
//
//   fem_stage run fem.json -o out/fem                  mesh, geostatic and shake, one after the other
//   fem_stage mesh fem.json -o out/fem --size coarse   geometry -> out/fem/mesh.msh
//   fem_stage geostatic fem.json --mesh out/fem/mesh.msh -o out/fem   -> geostatic.h5
//   fem_stage shake fem.json --geostatic out/fem/geostatic.h5 -o out/fem  -> snapshots, histories, summary.json
//   fem_stage shake fem.json --from out/fem/last_good_t07.1.h5 -o out/fem2   goes on from there
//   fem_stage shake ... --resume                       goes on from the folder's checkpoint after an interruption
//   fem_stage consolidate fem.json --mesh out/fem/mesh.msh --from out/fem/snapshot_t16.000.h5 -o out/consolidation
//   fem_stage element test.json -o out.csv             one material point under a laboratory test's loading
//   fem_stage calibrate target.json -o out/calibration parameters from a target strength
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <filesystem>

#include "common/application.hpp"
#include "common/case_file.hpp"
#include "common/case_settings.hpp"
#include "common/command_line.hpp"
#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "common/json_text.hpp"
#include "common/log.hpp"
#include "common/output_lock.hpp"
#include "common/output_place.hpp"
#include "common/patient_threads.hpp"
#include "common/plausible_state.hpp"
#include "fem_stage/element_test/calibration.hpp"
#include "fem_stage/element_test/element_test.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/own_weight.hpp"
#include "fem_stage/output/state_file.hpp"
#include "fem_stage/stage/geostatic.hpp"
#include "fem_stage/stage/shake.hpp"
#include "fem_stage/stage/summary.hpp"

using namespace tailrun;
using namespace tailrun::fem;
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string case_file, size, folder = ".", mesh, geostatic, from;
  bool trust_geometry = false, resume = false;
};

fs::path mesh_path(const Arguments& arguments) {
  return arguments.mesh.empty() ? fs::path(arguments.folder) / "mesh.msh" : fs::path(arguments.mesh);
}
fs::path geostatic_path(const Arguments& arguments) {
  return arguments.geostatic.empty() ? fs::path(arguments.folder) / "geostatic.h5" : fs::path(arguments.geostatic);
}

// What is wrong with the model is said with a pointer into the case; here the case's name comes before it.
Model model_of(const Arguments& arguments, const FemCase& options) {
  try {
    Model model = build_model(options, mesh_path(arguments));
    check_own_weight(CaseFile(arguments.case_file).root(), model);
    return model;
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* root : {"/boundaries", "/regions", "/loads", "/output", "/above_phreatic_line", "/phreatic_line"})
      if (text.rfind(root, 0) == 0) throw InputError(arguments.case_file + ": " + text);
    throw;
  }
}

// The case, and the folder of its results for this process alone. Whatever command comes: no result may take the place
// of what the case names. Meshes and states go by names of their own (mesh.msh, geostatic.h5, snapshots), which
// commands read from the folder.
FemCase case_with_folder(const Arguments& arguments) {
  FemCase options = read_fem_case(arguments.case_file, arguments.size);
  hold_output_folder(arguments.folder);
  std::vector<std::string> results = {"mesh.json",   "geostatic.json", "summary.json",           "consolidation.json",
                                      "history.csv", "quality.csv",    "snapshots.vtkhdf.series"};
  for (const char* stage : {"geostatic", "shake", "consolidation"})
    results.push_back(std::string(stage) + ".options.txt");
  require_results_apart(arguments.folder, results, options.inputs);
  return options;
}

// Geometry -> mesh.msh, or a copy of the case's own mesh file, with a report on its quality.
void make_mesh(const Arguments& arguments) {
  const FemCase options = case_with_folder(arguments);
  const fs::path output = fs::path(arguments.folder) / "mesh.msh";
  require_replaceable(output);
  Mesh mesh;
  if (!options.mesh.geometry.empty()) {
    mesh = mesh_geometry(options.mesh.geometry,
                         {options.mesh.parameters, options.mesh.time_limit, arguments.trust_geometry}, output);
  } else if (options.mesh.rectangle) {
    write_rectangle_mesh(*options.mesh.rectangle, output);
    mesh = read_gmsh(output);
  } else {
    mesh = read_gmsh(options.mesh.file);
    const fs::path temporary = output.string() + ".part";
    fs::copy_file(options.mesh.file, temporary, fs::copy_options::overwrite_existing);
    fs::rename(temporary, output);
  }
  const auto summary = mesh_summary(mesh);
  write_text_file((fs::path(arguments.folder) / "mesh.json").string(), text_of_json(summary, 2) + "\n");
  log_info("mesh: {} nodes, {} quadrilaterals, smallest scaled Jacobian {:.3f}", mesh.nodes(), mesh.elements(),
           summary["min_scaled_jacobian"].get<double>());
}

void tell_options(const Arguments& arguments, const FemCase& options, const std::string& stage, bool echo = true) {
  const fs::path all = fs::path(arguments.folder) / (stage + ".options.txt");
  const std::string title = fmt::format("fem_stage {} {}", stage, arguments.case_file);
  if (echo) echo_options(title, options.echo, all);
  write_options(all, title, options.echo);
}

// Mesh -> geostatic.h5: the dam at rest before the earthquake.
void make_geostatic(const Arguments& arguments) {
  FemCase options = case_with_folder(arguments);
  require_replaceable(fs::path(arguments.folder) / "geostatic.h5");
  tell_options(arguments, options, "geostatic");
  options.provenance.add_file(mesh_path(arguments));
  const Model model = model_of(arguments, options);
  MaterialPoints points = make_material_points(model);
  State state;
  const GeostaticReport report = run_geostatic(model, points, state);
  check_state(columns_of(make_snapshot(model, state, 0.0, 0.0, 0.0), arguments.case_file, {}, false));
  write_state(geostatic_path(arguments), model, state, points, 0.0, 0.0, 0.0);
  write_text_file((fs::path(arguments.folder) / "geostatic.json").string(),
                  text_of_json(geostatic_summary(report), 2) + "\n");
  log_info(
      "geostatic: residual {:.1e} of the weight (elastic {:.1e}, after the plastic switch {:.1e}), settled {:.1f} mm, "
      "largest tension {:.1f} kPa, {:.1f} s",
      report.final_residual, report.elastic_residual, report.switch_residual, 1e3 * report.settlement,
      1e-3 * report.largest_tension, report.seconds);
}

// A run goes on from `state`: its results must not overwrite those that led there.
void check_restart(const Arguments& arguments, const FemCase& options, const State& state, bool shaking) {
  const fs::path history = fs::path(arguments.folder) / "history.csv";
  if (fs::exists(history))
    throw InputError(history.string() + ": holds the results of a run; --from needs another folder (-o)");
  if (shaking && state.time >= options.shake.duration)
    throw InputError(fmt::format("{}: its time is {:g} s, but /shake/duration ends at {:g} s", arguments.from,
                                 state.time, options.shake.duration));
  if (!state.rotation.empty() && !options.shake.large_displacement)
    throw InputError(arguments.from +
                     ": was made with /shake/large_displacement, and its stresses are in turned frames; switch it on");
}

std::string resume_command(const Arguments& arguments) {
  std::string command = fmt::format("fem_stage shake {} -o {}", arguments.case_file, arguments.folder);
  for (const auto& [option, value] :
       {std::pair{"--size", arguments.size}, std::pair{"--mesh", arguments.mesh},
        std::pair{"--geostatic", arguments.geostatic}, std::pair{"--from", arguments.from}})
    if (!value.empty()) command += fmt::format(" {} {}", option, value);
  return command + settings_as_options() + " --resume";
}

// geostatic.h5 (or any state file) and the motion -> snapshots, histories, summary.json.
void make_shake(const Arguments& arguments, bool echo) {
  FemCase options = case_with_folder(arguments);
  const Motion motion = case_motion(options);
  tell_options(arguments, options, "shake", echo);
  options.provenance.add_file(mesh_path(arguments));
  if (!options.shake.motion.empty()) options.provenance.add_file(options.shake.motion);
  const fs::path start = arguments.from.empty() ? geostatic_path(arguments) : fs::path(arguments.from);
  options.provenance.add_file(start);
  const Model model = model_of(arguments, options);
  MaterialPoints points = make_material_points(model);
  State state;
  read_state(start, model, state, points);
  check_shake_output(options, static_cast<double>(fs::file_size(start)), arguments.folder);
  if (!arguments.from.empty()) check_restart(arguments, options, state, true);
  ShakeControl control;
  control.resume = arguments.resume;
  control.interruption = [](long) { return noted_signal(); };
  control.resume_command = resume_command(arguments);
  note_signals();
  const ShakeReport report = run_shake(model, points, state, motion, arguments.folder, control);
  const auto summary = shake_summary(model, motion, report);
  write_text_file((fs::path(arguments.folder) / "summary.json").string(), text_of_json(summary, 2) + "\n");
  if (!report.failure.empty())
    throw ComputationError(report.failure + "; the last good state is " +
                           (fs::path(arguments.folder) / report.snapshots.back()).string());
  log_info(
      "shake: {:.2f} s, largest displacement {:.2f} m, liquefied depth {:.1f} m, smallest scaled Jacobian {:.2f}, "
      "energy balance {:+.1e}, {:.0f} s",
      report.end_time, report.quality.back().largest_displacement, report.quality.back().liquefied_depth,
      summary["min_scaled_jacobian"].get<double>(), summary["energy_J"]["residual_of_largest"].get<double>(),
      report.wall_seconds);
}

// A state after the shaking -> its pore pressures at rest again.
void make_consolidation(const Arguments& arguments) {
  FemCase options = case_with_folder(arguments);
  tell_options(arguments, options, "consolidation");
  options.provenance.add_file(mesh_path(arguments));
  options.provenance.add_file(arguments.from);
  const Model model = model_of(arguments, options);
  MaterialPoints points = make_material_points(model);
  State state;
  read_state(arguments.from, model, state, points);
  check_restart(arguments, options, state, false);
  const ConsolidationReport report = run_consolidation(model, points, state, arguments.folder);
  const auto summary = consolidation_summary(report);
  write_text_file((fs::path(arguments.folder) / "consolidation.json").string(), text_of_json(summary, 2) + "\n");
  if (!report.failure.empty())
    throw ComputationError(report.failure + "; the last good state is " +
                           (fs::path(arguments.folder) / report.snapshots.back()).string());
  log_info("consolidation: {:.4g} s, largest r_u {:.3f} to {:.3f}, largest displacement {:.3f} m, {} steps, {:.1f} s",
           report.end_time - report.start_time, report.first_ratio, report.last_ratio, report.settlement,
           report.counts.steps, report.wall_seconds);
}

}  // namespace

int main(int argc, char** argv) {
  wait_patiently(argv);
  CommandLine line("Finite element stage: shaking and liquefaction triggering until the hand-over", "fem_stage");
  Arguments arguments;
  constexpr auto required = SubCommand::Need::required;
  const auto add_stage = [&](const char* name, const char* what) {
    SubCommand command = line.add_command(name, what);
    command.add("case", arguments.case_file, "fem.json", required);
    command.add("-o,--output", arguments.folder, "Folder of the results");
    command.add("--size", arguments.size, "Entry of /mesh/sizes in the case (coarse, default, fine)");
    return command;
  };
  const auto let_trust = [&](SubCommand command) {
    command.add_flag("--trust-geometry", arguments.trust_geometry,
                     "Let the geometry start programs and write files (SystemCall, Save ...)");
    return command;
  };
  const char* mesh_option = "Mesh file (default: mesh.msh in the results' folder)";
  let_trust(add_stage("mesh", "Geometry to mesh.msh")).does([&] { make_mesh(arguments); });

  SubCommand geostatic = add_stage("geostatic", "Gravity and water to geostatic.h5");
  geostatic.add("--mesh", arguments.mesh, mesh_option);
  geostatic.does([&] { make_geostatic(arguments); });

  SubCommand shake = add_stage("shake", "Earthquake from geostatic.h5 to snapshots");
  shake.add("--mesh", arguments.mesh, mesh_option);
  shake.add("--geostatic", arguments.geostatic, "Geostatic state (default: geostatic.h5 in the results' folder)");
  shake.add("--from", arguments.from, "Go on from this state (snapshot_t*.h5 or last_good_t*.h5)");
  shake.add_flag("--resume", arguments.resume,
                 "Go on from the results' folder's shake_checkpoint.h5, written by the same input");
  shake.does([&] { make_shake(arguments, true); });

  SubCommand consolidate = add_stage("consolidate", "Drainage and settlement after the shaking");
  consolidate.add("--mesh", arguments.mesh, mesh_option);
  consolidate.add("--from", arguments.from, "State after the shaking (snapshot_t*.h5)", required);
  consolidate.does([&] { make_consolidation(arguments); });

  let_trust(add_stage("run", "mesh, geostatic and shake")).does([&] {
    case_motion(read_fem_case(arguments.case_file, arguments.size));  // wrong? Then say so before computing
    make_mesh(arguments);
    make_geostatic(arguments);
    make_shake(arguments, false);
  });

  ElementTestOptions element_test;
  SubCommand element = line.add_command("element", "One material point under a laboratory test's loading");
  element.add("case", element_test.case_file, "test.json", required);
  element.add("-o,--output", element_test.output,
              "CSV of the response (SI; stresses and volumetric strain compression positive)");
  element.add("--summary", element_test.summary, "JSON summary (also printed)");
  element.does([&] {
    for (const auto& path : {element_test.output, element_test.summary})
      if (!path.empty()) check_output_file(path, {element_test.case_file});
    const auto full = [](const std::filesystem::path& path) { return absolute(path).lexically_normal(); };
    // absolute() of no path at all is an error of its own.
    if (!element_test.output.empty() && !element_test.summary.empty() &&
        full(element_test.output) == full(element_test.summary))
      throw InputError(fmt::format("--summary {}: is the curve's file, too (-o); give another name",
                                   std::filesystem::path(element_test.summary).string()));
    run_element_test(element_test);
  });

  CalibrationOptions calibration;
  calibration.output_folder = "calibration";
  SubCommand calibrate = line.add_command("calibrate", "PM4Sand parameters from target strengths");
  calibrate.add("case", calibration.case_file, "target.json", required);
  calibrate.add("-o,--output", calibration.output_folder, "Folder of curves, picture and parameters");
  calibrate.does([&] {
    hold_output_folder(calibration.output_folder);
    run_calibration(calibration);
  });
  return line.run(argc, argv);
}

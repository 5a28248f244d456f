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
//   mpm_stage run ... --set /time/end=20                  this value in place of the case file's
//   mpm_stage run ... --resume                            goes on from the folder's checkpoint, bit for bit
//
// The folder given with -o gets frames/ (particles files for ParaView and an index), front.csv, ledger.csv and
// summary.json. Exit status: 0 done, 1 bad input, 2 the computation failed or was interrupted (the last good state is
// on disk; after SIGINT or SIGTERM it is the state of that moment).
#include <fmt/core.h>

#include "common/application.hpp"
#include "common/case_settings.hpp"
#include "common/command_line.hpp"
#include "common/interrupt.hpp"
#include "common/output_lock.hpp"
#include "common/output_place.hpp"
#include "common/patient_threads.hpp"
#include "mpm_stage/output/place_checks.hpp"
#include "mpm_stage/run/program_of_solver.hpp"
#include "mpm_stage/run/runout.hpp"
#include "mpm_stage/scene/request_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

// Fewer keep a thread busy for less time than its start and end take in each phase of a step.
constexpr std::size_t particles_per_thread = 2000;

}  // namespace

int main(int argc, char** argv) {
  wait_patiently(argv);
  CommandLine line("Runout of liquefied soil by the material point method", "mpm_stage");
  constexpr auto required = SubCommand::Need::required;
  std::filesystem::path case_path, output, particles;
  std::string size;
  SubCommand command = line.add_command("run", "Run a case file (mpm.json)");
  command.add("case", case_path, "case file (JSON)", required);
  command.add("-o,--output", output, "folder for the results", required);
  command.add("--particles", particles, "particles file, in place of the case file's particles_file");
  command.add("--size", size, "entry of /sizes in the case (coarse, default, fine): its cell size");
  RunControl control;
  command.add_flag("--resume", control.resume,
                   "go on from the output folder's checkpoint.h5, written by the same input");
  command.does([&] {
    take_program_with_solver(case_path, argv);
    const CaseFile file(case_path);
    const Scene scene = read_scene(file, particles, size);
    file.finish();
    check_output_places(file.root(), scene);
    hold_output_folder(output);
    std::vector<std::filesystem::path> inputs = file.inputs();
    inputs.insert(inputs.end(), scene.inputs.begin(), scene.inputs.end());
    std::vector<std::string> results = {"summary.json", "options.txt", "front.csv",
                                        "ledger.csv",   "bodies.csv",  "sections.csv"};
    for (const auto& input : inputs) results.push_back("frames/" + input.filename().string());
    require_results_apart(output, results, inputs);
    if (!control.resume) check_space(scene, output);
    const std::string title = "mpm_stage run " + case_path.string();
    echo_options(title, file.echo(), output / "options.txt");
    write_options(output / "options.txt", title, file.echo());
    Provenance provenance;
    provenance.program = "mpm_stage";
    provenance.add_text(case_path, file.text());
    for (const auto& input : scene.inputs) provenance.add_file(input);
    control.resume_command = fmt::format("mpm_stage run {} -o {}", case_path.string(), output.string());
    if (!particles.empty()) control.resume_command += " --particles " + particles.string();
    if (!size.empty()) control.resume_command += " --size " + size;
    control.resume_command += settings_as_options() + " --resume";
    control.interruption = [](long) { return noted_signal(); };
    note_signals();
    limit_threads(scene.particles.count(), particles_per_thread);
    if (scene.dimension == 2)
      run_scene<2>(scene, output, provenance, control);
    else
      run_scene<3>(scene, output, provenance, control);
  });
  return line.run(argc, argv);
}

#include "mpm_stage/checkpoint/checkpoint.hpp"

#include <doctest/doctest.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "common/case_settings.hpp"
#include "common/error.hpp"
#include "mpm_stage/run/runout.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

// A strip of frictional soil with water, and one of clay that softens, fall apart on a slope between held sides.
const char* const case_text = R"({
  "grid": {"cell_size": 0.25},
  "domain": {"low": [-4, -4], "high": [6, 4], "leaving_particles": "wall"},
  "time": {"end": 0.6, "courant": 0.4},
  "materials": {
    "sand": {"model": "mohr_coulomb", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "cohesion": 0, "friction_angle": 30},
    "clay": {"model": "tresca", "youngs_modulus": 1e6, "poisson_ratio": 0.4, "cohesion": 2000,
             "softening": {"end_strain": 0.5, "cohesion_ratio": 0.2}}},
  "terrain": [{"points": [[-10, 0], [2, 0], [10, -4]], "friction": 0.3}],
  "bodies": [{"low": [-1, 0], "high": [-0.4, 1], "velocity_history": [[0, 2, 0], [0.3, 3, 1]]}],
  "particles": [
    {"shape": "box", "low": [0, 0], "high": [2, 1], "material": "clay", "velocity": [3, 0]},
    {"shape": "box", "low": [0, 1], "high": [2, 2], "material": "sand", "velocity": [3, 0]}],
  "output": {"frame_interval": 0.2, "series_interval": 0.02, "sections": [{"name": "drop", "at": 2.5}]}
})";

class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("tailrun_" + name + "_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// Runs the case text in `to`, stopping after `stop` steps (or the next ones, when it can go on from there) unless that
// is 0.
void run(const Folder& folder, const std::string& to, bool resume, long stop, const std::string& text = case_text) {
  std::ofstream(folder / "mpm.json") << text;
  const CaseFile file(folder / "mpm.json");
  const Scene scene = read_scene(file, {});
  Provenance provenance;
  provenance.program = "mpm_stage";
  provenance.add_text("mpm.json", file.text());
  RunControl control;
  control.resume = resume;
  control.resume_command = "run again";
  control.interruption = [stop](long steps) { return std::string(stop > 0 && steps >= stop ? "the test" : ""); };
  run_scene<2>(scene, folder / to, provenance, control);
}

}  // namespace

TEST_CASE("a run that was interrupted twice and went on leaves the same bytes as one in a piece") {
  const Folder folder("resume");
  std::string text = case_text;
  SUBCASE("all awake") {}
  SUBCASE("blocks that sleep") {
    text.insert(text.rfind('}'), R"(, "sleep": {"speed": 3.5, "calm": 0.03, "nap": 0.05})");
  }
  SUBCASE("water that falls on one side") {
    text.insert(text.rfind('}'), R"(, "ponded_water": [{"level_history": [[0, 1.7], [0.3, 0.9]], "x_to": 1}])");
  }
  SUBCASE("FMPM") {
    text.insert(text.rfind('}'), R"(, "scheme": {"transfer": "fmpm"})");
  }
  run(folder, "whole", false, 0, text);
  CHECK_THROWS_WITH_AS(run(folder, "parts", false, 37, text), doctest::Contains("checkpoint.h5"), ComputationError);
  CHECK_THROWS_WITH_AS(run(folder, "parts", true, 111, text), doctest::Contains("run again"), ComputationError);
  run(folder, "parts", true, 0, text);

  const std::string front = text_of(folder / "whole/front.csv"), ledger = text_of(folder / "whole/ledger.csv");
  REQUIRE(std::count(front.begin(), front.end(), '\n') > 20);
  CHECK(front == text_of(folder / "parts/front.csv"));
  CHECK(ledger == text_of(folder / "parts/ledger.csv"));
  CHECK(text_of(folder / "whole/sections.csv") == text_of(folder / "parts/sections.csv"));
  CHECK(text_of(folder / "parts/sections.csv").starts_with("time_s,drop_discharge_m2_s,drop_depth_m,"));
  CHECK(text_of(folder / "whole/frames/runout.vtkhdf.series") == text_of(folder / "parts/frames/runout.vtkhdf.series"));
  for (const char* frame : {"frames/runout_00001.vtkhdf", "frames/runout_00003.vtkhdf"}) {
    CAPTURE(frame);
    const ParticleSet a = read_particles(folder / ("whole/" + std::string(frame)));
    const ParticleSet b = read_particles(folder / ("parts/" + std::string(frame)));
    CHECK(a.position == b.position);
    CHECK(a.velocity == b.velocity);
    CHECK(a.effective_stress == b.effective_stress);
    CHECK(a.pore_pressure == b.pore_pressure);
    CHECK(a.volume == b.volume);
    CHECK(a.plastic_deviatoric_strain == b.plastic_deviatoric_strain);
  }
  const bool slept = text_of(folder / "parts/summary.json").find("\"share_asleep\": 0.0,") == std::string::npos;
  CHECK(slept == (text.find("sleep") != std::string::npos));
  CHECK_FALSE(std::filesystem::exists(folder / "parts/checkpoint.h5"));
}

TEST_CASE("a run does not go on with another case file, nor without a checkpoint") {
  const Folder folder("refuse");
  CHECK_THROWS_WITH_AS(run(folder, "out", true, 0), doctest::Contains("nothing to go on from"), InputError);
  CHECK_THROWS_AS(run(folder, "out", false, 5), ComputationError);
  std::string other = case_text;
  other.replace(other.find("\"friction\": 0.3"), 15, "\"friction\": 0.4");
  CHECK_THROWS_WITH_AS(run(folder, "out", true, 0, other), doctest::Contains("mpm.json"), InputError);
  CHECK(std::filesystem::exists(folder / "out/checkpoint.h5"));
}

TEST_CASE("a run goes on with a case file that differs in comments and spaces only") {
  const Folder folder("comments");
  CHECK_THROWS_AS(run(folder, "out", false, 5), ComputationError);
  CHECK_THROWS_WITH_AS(run(folder, "out", true, 9, "// why\n  " + std::string(case_text)),
                       doctest::Contains("run again"), ComputationError);
}

namespace {

void run_with(const std::vector<std::string>& settings, const Folder& folder, bool resume, long stop,
              const std::string& text = case_text) {
  struct TakeBack {
    ~TakeBack() { use_settings({}); }
  } at_the_end;
  use_settings(settings);
  run(folder, "out", resume, stop, text);
}

}  // namespace

TEST_CASE("a run goes on with the settings that it began with, or a case file that says the same, and no others") {
  const Folder folder("settings");
  const std::string pointer = "/time/end=";
  CHECK_THROWS_WITH_AS(run_with({pointer + "50"}, folder, false, 5), doctest::Contains("run again"), ComputationError);
  CHECK_THROWS_WITH_AS(run(folder, "out", true, 9), doctest::Contains("--set"), InputError);
  CHECK_THROWS_WITH_AS(run_with({pointer + "51"}, folder, true, 9), doctest::Contains("first at /time/end"),
                       InputError);
  CHECK_THROWS_WITH_AS(run_with({pointer + "50"}, folder, true, 9), doctest::Contains("run again"), ComputationError);
  std::string other = case_text;
  const std::size_t end = other.find("\"end\": ") + 7;
  other.replace(end, other.find_first_of(",}", end) - end, "50");
  CHECK_THROWS_WITH_AS(run(folder, "out", true, 12, other), doctest::Contains("run again"), ComputationError);
}

TEST_CASE("a cut-off checkpoint is refused") {
  const Folder folder("damaged");
  CHECK_THROWS_AS(run(folder, "out", false, 5), ComputationError);
  std::filesystem::resize_file(folder / "out/checkpoint.h5",
                               std::filesystem::file_size(folder / "out/checkpoint.h5") / 2);
  CHECK_THROWS_AS(run(folder, "out", true, 0), InputError);
}

namespace {

// Changes the values of a dataset or of an attribute of /numbers, as a program that damages them would.
template <class T>
void change(const std::filesystem::path& path, const std::string& name, hid_t type,
            const std::function<void(std::vector<T>&)>& action) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset);
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  action(values);
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
}

void set_number(const std::filesystem::path& path, const char* name, double value) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), group = H5Gopen2(file, "/numbers", H5P_DEFAULT);
  H5Adelete(group, name);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(group, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Gclose(group);
  H5Fclose(file);
}

}  // namespace

TEST_CASE("a checkpoint that cannot be a state of the run is refused, with the dataset") {
  const Folder folder("trusted");
  CHECK_THROWS_AS(run(folder, "out", false, 5), ComputationError);
  const auto checkpoint = folder / "out/checkpoint.h5", sound = folder / "sound.h5";
  std::filesystem::copy_file(checkpoint, sound);
  using Doubles = std::vector<double>;
  using Integers = std::vector<std::int64_t>;
  const auto doubles = [&](const std::string& name, const std::function<void(Doubles&)>& action) {
    return [=] { change<double>(checkpoint, name, H5T_NATIVE_DOUBLE, action); };
  };
  const auto integers = [&](const std::string& name, const std::function<void(Integers&)>& action) {
    return [=] { change<std::int64_t>(checkpoint, name, H5T_NATIVE_INT64, action); };
  };
  const auto number = [&](const char* name, double value) { return [=] { set_number(checkpoint, name, value); }; };
  const auto refused = [&](const std::function<void()>& damage, const std::string& what) {
    std::filesystem::copy_file(sound, checkpoint, std::filesystem::copy_options::overwrite_existing);
    damage();
    CAPTURE(what);
    CHECK_THROWS_WITH_AS(run(folder, "out", true, 0), doctest::Contains(what.c_str()), InputError);
    CHECK(std::filesystem::exists(checkpoint));
  };
  refused(doubles("/particles/position_0", [](Doubles& x) { x[7] = std::nan(""); }), "/particles/position_0");
  refused(doubles("/particles/position_1", [](Doubles& x) { x[3] += 5.0; }), "not in its block");
  refused(doubles("/particles/position_0", [](Doubles& x) { std::reverse(x.begin(), x.end()); }), "not in its block");
  refused(doubles("/particles/volume", [](Doubles& x) { x[0] = -1.0; }), "/particles/volume");
  refused(doubles("/particles/mass", [](Doubles& x) { x[0] *= 2.0; }), "another order");
  refused(integers("/particles/identity", [](Integers& x) { x[0] = x[1]; }), "is there twice");
  refused(integers("/particles/material", [](Integers& x) { x[0] = 1 - x[0]; }), "/particles/material");
  refused(integers("/grid/blocks", [](Integers& x) { x[0] = std::int64_t{1} << 40; }), "/grid/blocks");
  refused(integers("/grid/blocks", [](Integers& x) { x[2] = x[0], x[3] = x[1]; }), "does not come after");
  refused(doubles("/grid/wave_speed", [](Doubles& x) { x[0] = std::nan(""); }), "/grid/wave_speed");
  refused(doubles("/series/ledger", [](Doubles& x) { x[0] = 1e9; }), "/series/ledger");
  refused(number("time", std::nan("")), "'time' is nan");
  refused(number("time", 1e9), "'time' is 1e+09");
  refused(number("next_time_step", 0.0), "next_time_step");
  refused(number("steps", 2.5), "'steps' is 2.5");
  refused(number("drift", 7.0), "'drift' is 7");
}

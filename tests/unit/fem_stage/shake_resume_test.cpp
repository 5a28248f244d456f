// A shake that is interrupted and goes on leaves what one in a piece leaves: the same bits where its matrix is made
// anew now and then, the iteration's tolerance otherwise.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/output/state_file.hpp"
#include "fem_stage/stage/geostatic.hpp"
#include "fem_stage/stage/shake.hpp"
#include "fem_stage/stage/shake_checkpoint.hpp"

using namespace tailrun;
using namespace tailrun::fem;
namespace fs = std::filesystem;

namespace {

const fs::path place = fs::temp_directory_path() / "tailrun_shake_resume_test";

// A liquefying column on a rigid base, with residual strength, at large displacement: everything that a state has.
fs::path liquefying_column() {
  fs::create_directories(place);
  std::ofstream(place / "column.json")
      << R"({ "mesh": { "rectangle": { "width": 1, "height": 6, "columns": 1, "rows": 6,
      "region": "soil" } }, "phreatic_line": [[0, 6], [1, 6]],
    "materials": { "soil": { "model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 2.7, "Q": 11.998, "R": 3.75,
      "density": 1870, "residual_strength": { "model": "constant", "strength": 6000, "drained_cap": false } } },
    "regions": { "soil": { "material": "soil", "permeability": [1e-6, 1e-9] } },
    "boundaries": { "base": { "line": "bottom", "type": "rigid" }, "periodic_lines": ["left", "right"] },
    "loads": [ { "line": "top", "pressure": 20000 } ],
    "geostatic": { "settle_time": 1, "tolerance": 5e-3 },
    "shake": { "duration": 2, "large_displacement": true },
    "output": { "snapshots": [0.25, 1], "snapshot_interval": 0.5, "history_interval": 0.03, "points": { "top": [0, 6] } } })";
  return place / "column.json";
}

struct Run {
  FemCase options;
  Model model;
  MaterialPoints points{{}, {}};
  State state;
  Motion motion{.name = "sine", .time_step = 0.005, .acceleration = {}, .velocity = {}};

  explicit Run(const fs::path& case_file) : options(read_fem_case(case_file, "")) {
    const fs::path mesh = place / (case_file.stem().string() + ".msh");
    if (options.mesh.rectangle)
      write_rectangle_mesh(*options.mesh.rectangle, mesh);
    else
      mesh_geometry(options.mesh.geometry, {options.mesh.parameters, options.mesh.time_limit, false}, mesh);
    model = build_model(options, mesh);
    points = make_material_points(model);
    run_geostatic(model, points, state);
    for (int i = 0; i < 500; ++i) motion.acceleration.push_back(2.0 * std::sin(2.0 * 3.14159265358979 * 0.01 * i));
    motion.integrate();
  }
  ShakeReport shake(const fs::path& folder, long stop = 0, bool resume = false, double minutes = 5.0) {
    ShakeControl control;
    control.resume = resume;
    control.resume_command = "again";
    control.checkpoint_interval = minutes;
    control.interruption = [stop](long step) { return std::string(stop > 0 && step >= stop ? "the test" : ""); };
    return run_shake(model, points, state, motion, folder, control);
  }
};

std::string bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Rows of quality.csv without the column of wall time.
std::string without_wall(const fs::path& path) {
  std::ifstream stream(path);
  std::string text;
  for (std::string line; std::getline(stream, line);) text += line.substr(0, line.rfind(',')) + "\n";
  return text;
}

}  // namespace

TEST_CASE("a shake that was interrupted twice and went on leaves the bytes of one in a piece") {
  const fs::path case_file = liquefying_column();
  const auto whole = Run(case_file).shake(place / "whole");
  REQUIRE(whole.failure == "");
  CHECK_THROWS_WITH_AS(Run(case_file).shake(place / "parts", 60), "interrupted by the test; to go on: again",
                       InterruptedError);
  CHECK(fs::exists(place / "parts" / shake_checkpoint_name));
  for (const auto& entry : fs::directory_iterator(place / "parts"))
    CHECK_MESSAGE(entry.path().string().find(".part") == std::string::npos, entry.path());
  CHECK_THROWS_AS(Run(case_file).shake(place / "parts", 230, true), InterruptedError);
  const auto parts = Run(case_file).shake(place / "parts", 0, true);
  CHECK_FALSE(fs::exists(place / "parts" / shake_checkpoint_name));

  for (const auto& name : whole.snapshots) {
    CAPTURE(name);
    CHECK(bytes_of(place / "whole" / name) == bytes_of(place / "parts" / name));
  }
  for (const char* name : {"history.csv", "snapshots.vtkhdf.series"}) {
    CHECK(bytes_of(place / "whole" / name) == bytes_of(place / "parts" / name));
    CHECK(bytes_of(place / "whole" / name).size() > 100);
  }
  CHECK(without_wall(place / "whole" / "quality.csv") == without_wall(place / "parts" / "quality.csv"));
  CHECK(whole.snapshots.size() == 5);  // 0.25, 0.5, 1 (asked for twice), 1.5, 2
  CHECK(parts.snapshots == whole.snapshots);
  CHECK(parts.ledger.residual() == whole.ledger.residual());
  CHECK(parts.ledger.hourglass_work == whole.ledger.hourglass_work);
  CHECK(parts.counts.iterations == whole.counts.iterations);
  CHECK(parts.liquefaction == whole.liquefaction);
}

TEST_CASE("ParaView's index names every snapshot beside it, with its time") {
  const fs::path case_file = liquefying_column();
  const auto report = Run(case_file).shake(place / "indexed");
  const auto index = parse_json("index", bytes_of(place / "indexed" / "snapshots.vtkhdf.series"));
  CHECK(index.at("file-series-version") == "1.0");
  REQUIRE(index.at("files").size() == report.snapshots.size());
  for (std::size_t k = 0; k < report.snapshots.size(); ++k) {
    const auto& entry = index.at("files").at(k);
    CHECK(entry.at("name") == report.snapshots[k]);
    CHECK(fs::exists(place / "indexed" / entry.at("name").get<std::string>()));
    CHECK(entry.at("time").get<double>() == doctest::Approx(std::vector<double>{0.25, 0.5, 1.0, 1.5, 2.0}.at(k)));
  }
}

TEST_CASE("checkpoints on the way change nothing") {
  const fs::path case_file = liquefying_column();
  const auto report = Run(case_file).shake(place / "often", 0, false, 1e-9);
  CHECK(bytes_of(place / "whole" / report.snapshots.back()) == bytes_of(place / "often" / report.snapshots.back()));
  CHECK(report.snapshots.size() > 3);
}

TEST_CASE("a block between free-field columns, whose matrix is as old as the run, goes on with the same bits") {
  const fs::path case_file = fs::path(TAILRUN_SOURCE_DIR) / "cases/verification/free_field/fem.json";
  Run whole(case_file), first(case_file), second(case_file);
  for (Run* run : {&whole, &first, &second}) run->options.shake.duration = 0.5;
  whole.shake(place / "field");
  CHECK_THROWS_AS(first.shake(place / "field_parts", 50), InterruptedError);
  second.shake(place / "field_parts", 0, true);
  CHECK(second.state.displacement == whole.state.displacement);
  CHECK(second.state.stress == whole.state.stress);
}

TEST_CASE("what is no checkpoint of this shake is refused, and nothing is there to go on from at its end") {
  const fs::path case_file = liquefying_column();
  CHECK_THROWS_WITH_AS(Run(case_file).shake(place / "whole", 0, true), doctest::Contains("nothing to go on from"),
                       InputError);
  CHECK_THROWS_AS(Run(case_file).shake(place / "other", 20), InterruptedError);
  const std::string text = bytes_of(case_file);
  std::string changed = text;
  changed.replace(changed.find("20000"), 5, "21000");
  std::ofstream(case_file) << changed;
  CHECK_THROWS_WITH_AS(Run(case_file).shake(place / "other", 0, true), doctest::Contains("first at /loads/0/pressure"),
                       InputError);
  std::ofstream(case_file) << text;
  std::string damaged = bytes_of(place / "other" / shake_checkpoint_name);
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream(place / "other" / shake_checkpoint_name, std::ios::binary) << damaged;
  CHECK_THROWS_AS(Run(case_file).shake(place / "other", 0, true), InputError);
  fs::remove_all(place);
}

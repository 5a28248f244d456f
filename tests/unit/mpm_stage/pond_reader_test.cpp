// "ponded_water" of mpm.json, with and without ponds in the particles file.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/scene/scene.hpp"
#include "tests/unit/mpm_stage/four_particles.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

namespace fs = std::filesystem;

// The scene of a file of four particles that carries the pond "face", and what mpm.json says of ponds.
Scene read(const std::string& said, const std::string& gravity = "[0, -9.81]") {
  const fs::path stem = fs::temp_directory_path() / ("tailrun_ponds_" + std::to_string(getpid()));
  const fs::path particles_path = stem.string() + ".h5", case_path = stem.string() + ".json";
  ParticleSet p = four_particles({"soil"});
  p.ponds = {{"face", 3.0, {-5.0, 2.0}, {true, false}, 1030.0}};
  write_particles(particles_path, p, {});
  std::ofstream(case_path) << R"({"grid": {"cell_size": 1}, "time": {"end": 1}, "gravity": )" << gravity
                           << R"(, "materials": {"soil": {"model": "linear_elastic", "youngs_modulus": 1e7,
                                 "poisson_ratio": 0.3}})"
                           << (said.empty() ? "" : ", \"ponded_water\": " + said) << "}";
  const CaseFile file(case_path);
  fs::remove(case_path);
  const Scene scene = read_scene(file, particles_path);
  file.finish();
  fs::remove(particles_path);
  return scene;
}

}  // namespace

TEST_CASE("the ponds of the particles file press unless mpm.json says otherwise") {
  forget_warnings();
  const auto ponds = read("").solver.ponds;
  REQUIRE(ponds.size() == 1);
  CHECK(ponds[0].name == "face");
  CHECK(ponds[0].level_at(5.0) == 3.0);
  CHECK(ponds[0].low[0] == -Pond::endless);
  CHECK(ponds[0].high[0] == 2.0);
  CHECK(ponds[0].unit_weight == doctest::Approx(1030.0 * 9.81));
  const std::size_t before = warnings().size();
  CHECK(read("[]").solver.ponds.empty());
  REQUIRE(warnings().size() > before);
  CHECK(warnings().back().find("'face'") != std::string::npos);
  forget_warnings();
}

TEST_CASE("a pond of the file with a level of its own, and one given here") {
  const auto ponds = read(R"([{"from_particles": "face", "level_history": [[0, 3], [10, 1]], "x_to": 1.5},
                              {"name": "toe", "level": 0.5, "x_from": 2, "density": 1000}])")
                         .solver.ponds;
  REQUIRE(ponds.size() == 2);
  CHECK(ponds[0].level_at(5.0) == 2.0);
  CHECK(ponds[0].high[0] == 1.5);
  CHECK(ponds[1].low[0] == 2.0);
  CHECK(ponds[1].high[0] == Pond::endless);
}

TEST_CASE("frames carry the ponds with their level of that time") {
  const Scene scene = read(R"([{"from_particles": "face", "level_history": [[0, 3], [10, 1]]}])");
  const auto carried = ponds_at(scene, 5.0);
  REQUIRE(carried.size() == 1);
  CHECK(carried[0].level == 2.0);
  CHECK(carried[0].density == doctest::Approx(1030.0));
  CHECK(carried[0].endless == std::array<bool, 2>{true, false});
  CHECK(carried[0].extent[1] == 2.0);
  CHECK(carried[0].extent[0] < 2.0);
}

TEST_CASE("ponds that cannot be are refused") {
  CHECK_THROWS_WITH_AS(read(R"([{"from_particles": "fase"}])"), doctest::Contains("Did you mean 'face'?"), InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"level": 2, "x_from": 3, "x_to": 1}])"), doctest::Contains("x_to"), InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"level_history": [[0, 3], [0, 1]]}])"), doctest::Contains("does not come after"),
                       InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"name": "a", "level": 2}, {"name": "a", "level": 3}])"),
                       doctest::Contains("two ponds"), InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"level": 2}, {"level": 3}])"), doctest::Contains("both would press"), InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"name": "a", "level": 2, "x_to": 3}, {"name": "b", "level": 2, "x_from": 2.5}])"),
                       doctest::Contains("pond 'a' (x from -inf to 3 m)"), InputError);
  CHECK(read(R"([{"level": 2, "x_to": 3}, {"level": 1, "x_from": 3}])").solver.ponds.size() == 2);
  CHECK_THROWS_WITH_AS(read("", "[1, -9.81]"), doctest::Contains("/gravity"), InputError);
  CHECK_THROWS_WITH_AS(read(R"([{"x_to": 1}])"), doctest::Contains("level"), InputError);
}

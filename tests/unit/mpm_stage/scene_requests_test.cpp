// Scenes that ask for more than a machine has are refused before the start, with the numbers.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/scene/request_checks.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

struct Asked {
  std::string cell = "0.5", end = "1", time = {}, high = "[2, 2]", modulus = "1e6", output = {}, friction = "0.5",
              ground = "[-50, 0], [50, 0]", scheme = {};
};

Scene scene_of(const Asked& a) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("tailrun_scene_requests_{}.json", getpid());
  std::ofstream(path) << fmt::format(
      R"({{ "grid": {{ "cell_size": {} }}, "time": {{ "end": {}{} }},
      "materials": {{ "soil": {{ "model": "linear_elastic", "youngs_modulus": {}, "poisson_ratio": 0.3 }} }},
      "particles": [{{ "shape": "box", "low": [0, 0], "high": {}, "material": "soil" }}],
      "terrain": [{{ "points": [{}], "friction": {} }}], "output": {{ {} }}, "scheme": {{ {} }} }})",
      a.cell, a.end, a.time, a.modulus, a.high, a.ground, a.friction, a.output, a.scheme);
  const CaseFile file(path);
  return read_scene(file, {});
}

// The refusal, "" when the scene is read.
std::string refusal(const Asked& a) {
  try {
    scene_of(a);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void check(const Asked& asked, const char* words) {
  const std::string message = refusal(asked);
  CHECK_MESSAGE(message.find(words) != std::string::npos, message);
}

}  // namespace

TEST_CASE("an ordinary scene is read, and one that may stop at rest has no latest end") {
  CHECK(refusal({}) == "");
  CHECK(refusal({.end = "1e300"}) == "");
}

TEST_CASE("too many particles, cells, steps, frames and rows are refused with their numbers") {
  check({.cell = "1e-4", .high = "[2000, 2000]"}, "asks for 1.6e+15 particles");
  check({.high = "[1e300, 1e300]"}, "asks for");
  check({.cell = "1e-300"}, "/grid/cell_size: found 1e-300");
  check({.cell = "1e308"}, "/grid/cell_size: found 1e+308");
  check({.modulus = "1e30"}, "steps of");
  check({.time = R"(, "courant": 1e-300)"}, "steps of");
  check({.time = R"(, "maximum_step": 1e-300)"}, "maximum_step 1e-300 s");
  check({.end = "1e300", .time = R"(, "rest": { "stop": false })"}, "steps of");
  check({.output = R"("frame_interval": 1e-300)"}, "/output/frame_interval: found 1e-300 s");
  check({.output = R"("frame_interval": 1e-7)"}, "1e+07 frames in 1 s");
  check({.output = R"("series_interval": 1e-9)"}, "/output/series_interval: found 1e-09 s, which makes 1e+09 rows");
}

TEST_CASE("frames that the disk does not hold are refused with the space that is left") {
  Scene scene;
  scene.end_time = 1.0;
  scene.output.frame_interval = 1e-6;
  scene.particles.mass.assign(1000000, 1.0);
  scene.particles.position.assign(3000000, 0.0);
  CHECK_THROWS_WITH_AS(check_space(scene, std::filesystem::temp_directory_path()),
                       doctest::Contains("of 1000000 particles take 5e+04 GB or more"), InputError);
  scene.output.frame_interval = 0.0;
  CHECK_NOTHROW(check_space(scene, std::filesystem::temp_directory_path()));
}

TEST_CASE("a friction in degrees is warned of with its tangent") {
  for (const auto& [friction, warned] : {std::pair{"35", true}, std::pair{"1.5", false}}) {
    forget_warnings();
    CHECK(refusal({.friction = friction}) == "");
    bool found = false;
    for (const auto& text : warnings()) found = found || text.find("it would be 0.7") != std::string::npos;
    CHECK(found == warned);
  }
}

TEST_CASE("ground that crosses itself is refused with the place") {
  check({.ground = "[-50, 0], [50, 0], [50, 5], [44, -5]"},
        "/terrain/0/points: the line crosses or touches itself at (47, 0) m: segment 0 (points 0 and 1) and segment 2");
}

TEST_CASE("linear functions and GIMP take steps that a particle at a body's side bears, and say so") {
  struct Wanted {
    const char *shape, *courant;
    double taken;
  };
  for (const Wanted& wanted :
       {Wanted{"gimp", "0.8", 0.463}, {"linear", "0.8", 0.424}, {"gimp", "0.3", 0.3}, {"quadratic", "0.8", 0.8}}) {
    CAPTURE(wanted.shape);
    forget_warnings();
    const Scene scene = scene_of({.time = fmt::format(R"(, "courant": {})", wanted.courant),
                                  .scheme = fmt::format(R"("shape_function": "{}")", wanted.shape)});
    CHECK(scene.solver.courant == doctest::Approx(wanted.taken).epsilon(2e-3));
    CHECK(warnings().empty() == (wanted.taken == std::stod(wanted.courant)));
  }
  forget_warnings();
  CHECK(scene_of({.scheme = R"("shape_function": "gimp")"}).solver.courant == doctest::Approx(0.463).epsilon(2e-3));
  CHECK(warnings().empty());
}

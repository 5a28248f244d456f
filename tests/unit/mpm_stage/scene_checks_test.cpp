// What can be computed but is no soil on this earth is refused or warned of; what is merely unusual is read in silence.
#include <doctest/doctest.h>

#include "tests/unit/mpm_stage/four_particles.hpp"
#include "tests/unit/mpm_stage/small_scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

void warned(const std::string& changes, const std::string& words) {
  const Answer answer = answer_with(changes);
  CHECK_MESSAGE(answer.warns(words), changes << " -> " << answer.text());
}

void refused(const std::string& changes, const std::string& words) {
  const Answer answer = answer_with(changes);
  CHECK_MESSAGE(answer.refuses(words), changes << " -> " << answer.text());
}

void silent(const std::string& changes) {
  const Answer answer = answer_with(changes);
  CHECK_MESSAGE(answer.silent(), changes << " -> " << answer.text());
}

// The soil's entry with these keys more.
std::string soil(const std::string& keys) {
  return R"({"materials": {"soil": {)" + keys + "}}}";
}

std::string fluid(const std::string& keys) {
  return R"({"materials": {"soil": {"model": "newtonian_fluid", "youngs_modulus": null, "poisson_ratio": null,
             "cohesion": null, "friction_angle": null, )" +
         keys + "}}}";
}

std::string grains(const std::string& keys) {
  return R"({"materials": {"soil": {"model": "mu_i", "cohesion": null, "friction_angle": null, "density": 1500,
             "mu_s": 0.38, "mu_2": 0.64, )" +
         keys + "}}}";
}

std::string shape(const std::string& keys) {
  return R"({"particles": [{"shape": "box", "low": [0, 0], "high": [4, 2], "material": "soil", )" + keys + "}]}";
}

}  // namespace

TEST_CASE("gravity in another unit is warned of with the unit that fits") {
  silent("{}");
  silent(R"({"gravity": [0, 0]})");
  silent(R"({"gravity": [4.3, -8.817]})");
  silent(R"({"gravity": [0, -10]})");
  warned(R"({"gravity": [0, -32.2]})", "/gravity: 32.2 m/s2; 32.2 ft/s2 are");
  warned(R"({"gravity": [0, -981]})", "981 cm/s2 are 9.81 m/s2");
  warned(R"({"gravity": [0, -1]})", "1 g are 9.81 m/s2");
}

TEST_CASE("gravity that presses soil on nothing is refused") {
  refused(R"({"gravity": [0, 9.81]})",
          "/gravity: found [0, 9.81] m/s2, which presses soil on none of the ground lines");
  refused(R"({"gravity": [-9.81, 0]})", "presses soil on none");
  // A wall that soil leans on, and one that holds it.
  warned(R"({"gravity": [-9.81, 0], "domain": {"low": [0, -1], "high": [9, 9], "walls": {"left": {"kind": "slip"}}}})",
         "points 90 degrees off straight down");
  warned(R"({"gravity": [0, 9.81], "domain": {"low": [0, -1], "high": [9, 9], "walls": {"left": {"kind": "fixed"}}}})",
         "points 180 degrees off straight down");
}

TEST_CASE("velocities beyond those of slides are warned of, impossible ones refused, with count and place") {
  silent(shape(R"("velocity": [30, 0])"));
  warned(shape(R"("velocity": [150, 0])"),
         "128 of 128 particles start faster than 100 m/s, up to 150 m/s ('soil' at (");
  refused(shape(R"("velocity": [1e9, 0])"),
          "/particles: 128 of 128 particles start faster than 100 m/s, up to 1e+09 m/s");
  refused(R"({"bodies": [{"name": "plate", "low": [9, 0], "high": [10, 2], "velocity": [-1e4, 0]}]})",
          "/bodies/0: 'plate' moves with up to 1e+04 m/s");
}

TEST_CASE("soil that starts faster than its own waves is warned of") {
  // c = sqrt(1.346 E / rho).
  warned(R"({"materials": {"soil": {"youngs_modulus": 5e5}}, "particles": [{"shape": "box", "low": [0, 0],
             "high": [4, 2], "material": "soil", "velocity": [30, 0]}]})",
         "faster than waves in their material, up to 30 m/s where these have 18.3 m/s");
}

TEST_CASE("grains in millimetres or g/cm3") {
  silent(grains(R"("grain_diameter": 5e-4)"));
  warned(grains(R"("grain_diameter": 0.5)"),
         "/materials/soil/grain_diameter: 0.5 m is the size of boulders; 0.5 mm are 0.0005");
  refused(grains(R"("grain_diameter": 5e-4, "grain_density": 2.65)"), "2.65 g/cm3 are 2650 kg/m3");
  warned(grains(R"("grain_diameter": 5e-4, "grain_density": 1400)"), "is more than the grains have alone");
}

TEST_CASE("a fluid that its own weight would crush") {
  silent(fluid(R"("density": 1000, "bulk_modulus": 2e6)"));
  warned(fluid(R"("density": 1000, "bulk_modulus": 2.2)"), "/materials/soil/bulk_modulus: 2.2 Pa: under ");
}

TEST_CASE("pore water as soft as air") {
  warned(soil(R"("pore_pressure": "undrained", "pore_stiffness": 2200)"),
         "/materials/soil/pore_stiffness: 2200 Pa is far below");
}

TEST_CASE("softening that softens nothing") {
  silent(soil(R"("softening": {"end_strain": 0.1, "cohesion_ratio": 0.5})"));
  silent(soil(R"("softening": {"end_strain": 0.1, "residual_friction_angle": 20})"));
  warned(soil(R"("softening": {"end_strain": 0.1})"),
         "/materials/soil/softening: nothing softens: cohesion_ratio is 1");
  warned(soil(R"("cohesion": 0, "softening": {"end_strain": 0.1, "cohesion_ratio": 0.5})"), "the soil has no cohesion");
}

TEST_CASE("angles in radians, in materials and where they soften") {
  warned(soil(R"("dilation_angle": 0.2)"), "/materials/soil/dilation_angle: 0.2 degrees; 0.2 radians");
  warned(soil(R"("softening": {"end_strain": 0.1, "residual_friction_angle": 0.35})"),
         "/materials/soil/softening/residual_friction_angle: 0.35 degrees; 0.35 radians would be 20.1");
}

TEST_CASE("moving bodies that never meet anything") {
  const auto plate = [](const std::string& keys) { return R"({"bodies": [{"name": "plate", )" + keys + "}]}"; };
  silent(plate(R"("low": [9, 0], "high": [10, 2], "velocity": [0, 0])"));
  silent(plate(R"("low": [0, 2], "high": [4, 3], "velocity": [0, -0.1])"));
  // A barrier far down the valley, and a block that comes down on the soil from above.
  silent(plate(R"("low": [90, 0], "high": [91, 2], "velocity": [0, 0])"));
  silent(plate(R"("low": [0, 40], "high": [4, 41], "velocity": [0, -50])"));
  warned(plate(R"("low": [9000, 0], "high": [10000, 2000], "velocity": [0, 0])"),
         "/bodies/0: 'plate' is never near anything: on its way through the run it has x from 9000 to 1e+04 m");
  warned(plate(R"("low": [0, -4], "high": [4, -2], "velocity": [0, 0.1])"), "'plate' stays under the ground");
  warned(R"({"domain": {"low": [-1, -1], "high": [9, 9]},
             "bodies": [{"name": "plate", "low": [20, 0], "high": [21, 2], "velocity": [1, 0]}]})",
         "the domain has x from -1 to 9 m");
}

TEST_CASE("histories of bodies in milliseconds, after the run, within a step") {
  const auto history = [](const std::string& rows) {
    return R"({"bodies": [{"name": "plate", "low": [9, 0], "high": [10, 2], "velocity_history": )" + rows + "}]}";
  };
  silent(history("[[0, 0, 0], [0.5, -1, 0], [1, 0, 0]]"));
  silent(history("[[0, 0, 0], [10, -1, 0]]"));
  silent(history("[[0, 0, 0], [0.5, -1, 0], [0.6, -1, 0], [0.7, -1, 0], [100, 0, 0]]"));
  silent(history("[[0, 0, 0], [1e-9, -1, 0]]"));  // a jump
  warned(history("[[0, 0, 0], [500, -1, 0], [1000, 0, 0]]"),
         "/bodies/0/velocity_history: goes to 1000 s, but the run is over after 1 s, with 1 of its 3 rows; 1000 ms are "
         "1 s");
  warned(history("[[500, 0, 0], [600, -1, 0]]"), "begins at 500 s, when the run of 1 s is over");
  warned(history("[[0, 0, 0], [1e-6, -1, 0], [2e-6, 0, 0]]"), "all its 3 rows lie within 2e-06 s");
}

TEST_CASE("two bodies, or two lines of the ground, in one place") {
  const auto twice = [](const std::string& velocity) {
    return R"({"bodies": [{"name": "a", "low": [9, 0], "high": [10, 2], "velocity": [0, 0]},
                          {"name": "b", "low": [9, 0], "high": [10, 2], "velocity": )" +
           velocity + "}]}";
  };
  warned(twice("[0, 0]"), "/bodies/1: 'b' is where 'a' (/bodies/0) is and moves as that does");
  refused(twice("[-1, 0]"), "/bodies/1: 'b' begins in the place of 'a' (/bodies/0) and moves otherwise");
  const auto ground = [](const std::string& line) {
    return R"({"terrain": [{"points": [[-50, 0], [10, 0], [50, 0]], "friction": 0.5}, )" + line + "]}";
  };
  warned(ground(R"({"points": [[-50, 0], [50, 0]], "friction": 0.5})"),
         "/terrain/1: line 'terrain_1' lies on line 'terrain_0' (/terrain/0) over 100 m: the same ground twice");
  refused(ground(R"({"points": [[-50, 0], [50, 0]], "friction": 0.3})"), "it is not told which one holds");
  // A wall on the ground, and ground that goes on with a few metres in common.
  silent(ground(R"({"points": [[20, 0], [20, 5]], "friction": 0.5})"));
  silent(ground(R"({"points": [[45, 0], [80, 0], [99, 9]], "friction": 0.3})"));
}

TEST_CASE("frames and rows that come after the end") {
  silent(R"({"output": {"frame_interval": 1, "series_interval": 0.5}})");
  silent(R"({"output": {"frame_interval": 0}})");
  warned(R"({"output": {"frame_interval": 100}})",
         "/output/frame_interval: 100 s is longer than the run (/time/end, 1 s): there is nothing between");
  warned(R"({"output": {"series_interval": 50}})", "50 ms are 0.05 s");
}

TEST_CASE("stiffness and strength a thousand times too large") {
  warned(soil(R"("youngs_modulus": 1e13)"), "/materials/soil/youngs_modulus: 1e+13 Pa is more than any matter has");
  warned(soil(R"("cohesion": 1e7)"), "/materials/soil/cohesion: 1e+07 Pa is 1 of Young's modulus");
}

TEST_CASE("the width of a shear band in another unit") {
  const auto with = [](const std::string& length) {
    return soil(R"("softening": {"end_strain": 0.1, "cohesion_ratio": 0.5, "reference_length": )" + length + "}");
  };
  silent(with("0.1"));
  warned(with("1e-9"), "/softening/reference_length: 1e-09 m is the width");
  warned(with("100"), "falls over strains 200 times those given");
}

TEST_CASE("a friction in degrees is warned of wherever friction is said") {
  silent(R"({"terrain": [{"points": [[-50, 0], [50, 0]], "friction": 10}]})");
  warned(R"({"terrain": [{"points": [[-50, 0], [50, 0]], "friction": 0.5, "friction_regions": [[-50, 50, 30]]}]})",
         "/terrain/0/friction_regions/0: 30 on 'terrain_0' is a coefficient");
  warned(R"({"domain": {"low": [-1, -1], "high": [9, 9], "walls": {"left": {"kind": "frictional", "friction": 30}}}})",
         "/domain/walls/left/friction: 30 on the wall 'left' is a coefficient, not an angle; were it meant in degrees, "
         "it would be 0.577");
  warned(R"({"contact": {"friction": 30}})", "/contact/friction: 30 on the surfaces between fields");
}

TEST_CASE("ponds off the scene, without water, or on another datum") {
  silent(R"({"ponded_water": [{"level": 1}]})");
  silent(R"({"ponded_water": [{"level": 9}]})");
  // Water in a hollow in front of the soil, below all of it.
  silent(R"({"terrain": [{"points": [[-50, 0], [10, 0], [20, -5], [50, -5]], "friction": 0.5}],
             "ponded_water": [{"level": -1, "x_from": 5}]})");
  warned(R"({"ponded_water": [{"level": 4000}]})", "stands 3998 m over the highest soil there (level 4000 m");
  warned(R"({"ponded_water": [{"level": -3}]})", "pond 'pond_1' has no water: its level, -3 m, lies below all ground");
  warned(R"({"ponded_water": [{"level": 1, "x_from": 600}]})", "lies off the scene and presses on nothing");
}

TEST_CASE("particles outside of the domain are refused before anything is computed, with count and place") {
  const std::string domain = R"({"domain": {"low": [-1, -1], "high": [3, 3])";
  silent(R"({"domain": {"low": [-1, -1], "high": [4, 3]}})");
  refused(domain + "}}",
          "/domain: 32 of 128 particles lie outside of the domain, which goes from (-1, -1) m to (3, 3) m; the first "
          "is 'soil' at (3.125, 0.125) m");
  warned(domain + R"(, "leaving_particles": "remove"}})", "takes them out in the first step");
  refused(R"({"domain": {"low": [5, -1], "high": [9, 3], "leaving_particles": "remove"}})", "128 of 128 particles");
}

TEST_CASE("stresses of another datum, and a surface under the shape") {
  silent(shape(R"("stress": {"kind": "geostatic", "surface": 2})"));
  warned(shape(R"("stress": {"kind": "geostatic", "surface": 400})"),
         "vertical stresses of up to 7.85e+06 Pa are given");
  warned(shape(R"("stress": {"kind": "geostatic", "surface": -1})"),
         "/particles/0/stress: gives no stress: its surface, y = -1 m");
}

TEST_CASE("soil that hangs far over the ground") {
  silent(R"({"terrain": [{"points": [[-50, -1], [50, -1]], "friction": 0.5}]})");
  warned(R"({"terrain": [{"points": [[-50, -400], [50, -400]], "friction": 0.5}]})",
         "/terrain: all soil hangs in the air: the particle nearest to the ground is 400.1 m off");
}

TEST_CASE("thresholds that decide over the result") {
  silent(R"({"sleep": {"speed": 0.01}})");
  warned(R"({"time": {"rest": {"speed": 10}}})",
         "/time/rest/speed: 10 m/s: soil that flows more slowly counts as at rest");
  warned(R"({"sleep": {"speed": 1}})", "/sleep/speed: 1 m/s");
  warned(R"({"time": {"energy_growth_limit": 1}})", "/time/energy_growth_limit: 1 is 100 %");
  warned(R"({"output": {"flow_distance": 1e5}})", "/output/flow_distance: 100000 m");
}

TEST_CASE("a viscosity that asks for steps without end") {
  silent(fluid(R"("density": 1000, "bulk_modulus": 2e6, "viscosity": 1)"));
  refused(fluid(R"("density": 1000, "bulk_modulus": 2e6, "viscosity": 1e12)"), "/materials: 3.2e+10 steps of");
}

TEST_CASE("strengths of a table in kPa") {
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_scene_checks_" + std::to_string(getpid()) + ".h5");
  ParticleSet particles = four_particles({"soil"});
  particles.initial_vertical_effective_stress.assign(4, 1e4);
  write_particles(path, particles, {});
  const auto with = [&path](const std::string& table) {
    return answer_to(small_scene_with(soil(R"("cohesion": "table", "cohesion_table": )" + table)), path);
  };
  CHECK(with("[[0, 1], [1e5, 20]]").warns("/materials/soil/cohesion_table: 20 Pa is a thousandth"));
  CHECK(!with("[[0, 1000], [1e5, 20000]]").warns("cohesion_table"));
  std::filesystem::remove(path);
}

TEST_CASE("steps that lone particles between other soil do not bear") {
  // Soil beside clay, which has a velocity field of its own; both with waves of some 200 m/s.
  const auto beside_clay = [](const std::string& courant, const std::string& soil_keys) {
    return R"({"time": {"courant": )" + courant +
           R"(}, "materials": {"soil": {"model": "mohr_coulomb", "density": 2000, "youngs_modulus": 5e7,
      "poisson_ratio": 0.3, )" +
           soil_keys +
           R"(}, "clay": {"model": "tresca", "density": 2000, "youngs_modulus": 5e6, "poisson_ratio": 0.49, "cohesion": 5e3}},
      "particles": [{"shape": "box", "low": [0, 0], "high": [2, 2], "material": "soil"}, {"shape": "box", "low": [2, 0], "high": [4, 2], "material": "clay"}]})";
  };
  const std::string sand = R"("cohesion": 0, "friction_angle": 34)",
                    cemented = R"("cohesion": 5e3, "friction_angle": 34)";
  silent(beside_clay("0.7", sand));
  CHECK(answer_with(beside_clay("0.75", sand)).warns("0.7 let single particles of 'clay'"));
  silent(beside_clay("0.5", cemented));
  CHECK(answer_with(beside_clay("0.7", cemented)).warns("let single particles of 'soil'"));
  silent(beside_clay("0.7", cemented + R"(, "tension_cutoff": 0)"));
}

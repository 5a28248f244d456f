// Keys that say two things at once, or nothing: refused with what they need, or warned of.
#include <doctest/doctest.h>

#include "common/particles.hpp"
#include "tests/unit/mpm_stage/four_particles.hpp"
#include "tests/unit/mpm_stage/small_scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

void refused(const std::string& changes, const std::string& words) {
  const Answer answer = answer_with(changes);
  CHECK_MESSAGE(answer.refuses(words), changes << " -> " << answer.text());
}

void warned(const std::string& changes, const std::string& words) {
  const Answer answer = answer_with(changes);
  CHECK_MESSAGE(answer.warns(words), changes << " -> " << answer.text());
}

// The ground with these regions of another friction; its segments have their middles at -20 and 30 m.
std::string regions(const std::string& rows) {
  return R"({"terrain": [{"points": [[-50, 0], [10, 0], [50, 0]], "friction": 0.5, "friction_regions": )" + rows +
         "}]}";
}

// Two soils beside each other, and what mpm.json says of their contact.
std::string contact(const std::string& keys) {
  return R"({"materials": {"clay": {"model": "tresca", "youngs_modulus": 5e6, "poisson_ratio": 0.49, "cohesion": 3000}},
             "particles": [{"shape": "box", "low": [0, 0], "high": [4, 2], "material": "soil"},
                           {"shape": "box", "low": [4, 0], "high": [8, 2], "material": "clay"}],
             "contact": {)" +
         keys + "}}";
}

std::string domain(const std::string& high, const std::string& wall) {
  return R"({"domain": {"low": [-1, -1], "high": )" + high + R"(, "walls": {"left": )" + wall + "}}}";
}

}  // namespace

TEST_CASE(
    "regions of friction: swapped ends, negative friction and overlaps are refused, one without ground warned of") {
  CHECK(answer_with(regions("[[-50, 10, 0.3], [10, 50, 0.4]]")).silent());
  refused(regions("[[10, -50, 0.3]]"), "/terrain/0/friction_regions/0: goes from 10 to -50 m");
  refused(regions("[[-50, 10, -0.3]]"), "found a friction of -0.3, but allowed is [0, inf)");
  refused(regions("[[-50, 10, 0.3], [0, 50, 0.4]]"),
          "/terrain/0/friction_regions/1: holds x from 0 to 10 m, which region 0 does, too");
  warned(regions("[[100, 200, 0.3]]"),
         "holds the middle of no segment of 'terrain_0', so its friction of 0.3 is nowhere; the middles of its 2 "
         "segments lie from -20 to 30 m");
}

TEST_CASE("the corners of a domain, swapped, and a friction that its wall does not have") {
  CHECK(answer_with(domain("[9, 9]", R"({"kind": "slip"})")).silent());
  refused(domain("[-9, 9]", R"({"kind": "slip"})"), "/domain/high: is -9 m along x, but must be more than low, -1 m");
  refused(domain("[9, 9]", R"({"kind": "slip", "friction": 0.3})"),
          "/domain/walls/left/friction: goes with kind 'frictional', but 'kind' is 'slip'");
}

TEST_CASE("keys of contact say which choice of fields they go with") {
  CHECK(answer_with(contact(R"("fields": "named", "groups": [{"materials": ["soil"]}, {"materials": ["clay"]}])"))
            .silent());
  refused(contact(R"("groups": [{"materials": ["soil"]}, {"materials": ["clay"]}])"),
          "/contact/groups: goes with fields 'named', but 'fields' is 'strength' unless it is given");
  refused(contact(R"("fields": "named", "groups": [{"materials": ["soil", "soil"]}, {"materials": ["clay"]}])"),
          "/contact/groups/0/materials: names 'soil' twice");
  refused(contact(R"("fields": "named", "groups": [{"materials": ["soil"]}, {"materials": ["clay", "soil"]}])"),
          "names 'soil', which /contact/groups/0 has already");
  refused(contact(R"("fields": "one", "friction": 0.3)"), "/contact/friction: goes with fields 'strength' or 'named'");
  warned(R"({"contact": {"friction": 0.3}})", "/contact/friction: does nothing");
}

TEST_CASE("keys of the scheme say which transfer they go with") {
  refused(R"({"scheme": {"flip_share": 0.9}})",
          "/scheme/flip_share: goes with transfer 'flip', but 'transfer' is 'aflip'");
}

TEST_CASE("names that would break a table's header are refused") {
  for (const char* name : {"a,b", "a\\\"b", "a\\nb", ""}) {
    const std::string said = R"("name": ")" + std::string(name) + R"(")";
    refused(R"({"output": {"points": [{)" + said + R"(, "position": [1, 1]}]}})", "/output/points/0/name: \"");
    refused(R"({"output": {"sections": [{)" + said + R"(, "at": 1}]}})", "/output/sections/0/name: \"");
    refused(R"({"bodies": [{)" + said + R"(, "low": [9, 0], "high": [10, 2], "velocity": [0, 0]}]})",
            "/bodies/0/name: \"");
  }
  refused(R"({"output": {"points": [{"name": "a", "position": [1, 1]}, {"name": "a", "position": [2, 1]}]}})",
          "/output/points/1/name: there is a point 'a' already");
  refused(R"({"output": {"points": [{"name": "centre", "position": [1, 1]}]}})",
          "has its columns in front.csv already");
}

TEST_CASE("places of the output where there is no soil are warned of") {
  CHECK(answer_with(R"({"output": {"points": [{"name": "crest", "position": [4, 2]}], "toe": 4, "footprint": [0, 4],
                                   "sections": [{"name": "valley", "at": 20}]}})")
            .silent());
  warned(R"({"output": {"points": [{"name": "crest", "position": [1e5, 2]}]}})",
         "/output/points/0/position: 'crest' at (100000, 2) m is 1e+05 m from the nearest soil");
  warned(R"({"output": {"sections": [{"name": "valley", "at": 1e5}]}})",
         "/output/sections/0/at: 'valley' at 100000 m: far beyond the ground that was drawn");
  warned(R"({"output": {"sections": [{"name": "valley", "at": -20}]}})", "all soil that can move lies ahead of it");
  warned(R"({"output": {"toe": 4000}})", "/output/toe: 4000 m is off the dam");
  warned(R"({"output": {"footprint": [10, 20]}})", "/output/footprint: [10, 20] m holds no soil");
}

TEST_CASE("particles from two places at once, or from none") {
  const auto path = std::filesystem::temp_directory_path() / ("tailrun_scene_keys_" + std::to_string(getpid()) + ".h5");
  write_particles(path, four_particles({"soil"}), {});
  CHECK(answer_to(small_scene(), path).warns("/particles: these shapes are left out: --particles "));
  CHECK(answer_with(R"({"particles_file": "particles.h5"})").refuses("/particles_file: is given beside 'particles'"));
  CHECK(answer_with(R"({"particles": null})").refuses("has no particles: 'particles' (shapes to fill)"));
  CHECK(answer_to(small_scene_with(R"({"particles": null})"), path).refusal.empty());
  std::filesystem::remove(path);
}

TEST_CASE("a record scaled by its peak in g is warned of, as in fem.json") {
  const auto path =
      std::filesystem::temp_directory_path() / ("tailrun_scene_keys_" + std::to_string(getpid()) + ".csv");
  std::ofstream(path) << "time,acceleration\n0,0\n0.01,2.5\n0.02,-2.5\n0.03,0\n";
  const auto with = [&path](const std::string& peak) {
    Json scene = small_scene();
    scene["base_motion"] = {{"file", path.string()}, {"peak_acceleration", Json::parse(peak)}, {"start", 0}};
    return answer_to(scene);
  };
  CHECK(with("2").silent());
  CHECK(with("0.25").warns("if 0.25 g is meant, write 2.4"));
  CHECK(with("80").warns("scales "));
  std::filesystem::remove(path);
}

TEST_CASE("--size says that it changes nothing where a case has no sizes") {
  CHECK(answer_to(small_scene(), {}, "coarse").warns("/sizes: --size coarse changes nothing: this case has no sizes"));
  CHECK(answer_to(small_scene(), {}, "default").silent());
  CHECK(answer_to(small_scene_with(R"({"sizes": {"coarse": {"cell_size": 1}}})"), {}, "coarse").silent());
}

#include "transfer_tool/assign/rules.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

const std::vector<std::string> regions = {"lower", "upper"};

std::vector<Rule> rules_of(const std::string& json) {
  const example::TemporaryFolder folder;
  const tailrun::CaseFile file(folder.write("rules.json", R"({"rules": )" + json + "}"));
  auto rules = read_rules(file.root().list("rules"), regions);
  file.finish();
  return rules;
}

std::string error_of(const std::string& json) {
  return example::message_of<tailrun::InputError>([&] { rules_of(json); });
}

// One point per element of a 2 x 4 m rectangle; r_u rises with x, sigma'_v0 is 10 kPa per metre of depth.
struct Column {
  tailrun::Snapshot mesh = example::rectangle(2, 4, 0.0);
  SamplePoints points;
  PointState state;
  Column() {
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
      mesh.excess_pore_pressure_ratio[e] = e % 2 ? 0.9 : 0.3;
      mesh.initial_vertical_effective_stress[e] = 1e4 * (3.5 - static_cast<double>(e / 2));
    }
    points = example::sample_all(mesh, Layout::gauss, 1);
    MapOptions options;
    options.initial_stress = Recovery::element;
    state = map_state(mesh, points, options);
    // Interpolated depths carry round-off; the bounds are tried on exact ones.
    for (std::size_t e = 0; e < mesh.elements(); ++e) state.depth[e] = 3.5 - static_cast<double>(e / 2);
  }
  std::vector<std::string> materials(const std::string& json) const {
    const Assignment found = assign(mesh, points, state, rules_of(json));
    std::vector<std::string> names;
    for (const auto id : found.material_id) names.push_back(found.material_names[static_cast<std::size_t>(id)]);
    return names;
  }
};

}  // namespace

TEST_CASE("the first rule that fits wins") {
  const Column column;
  const auto names = column.materials(R"([
    {"material": "liquefied", "when": {"region": ["upper"], "any": [{"excess_pore_pressure_ratio": {"above": 0.7}},
                                                                   {"depth": {"at_most": 1}}]}},
    {"material": "tailings", "when": {"region": "upper"}},
    {"material": "rock"}])");
  // rows from the bottom: two of the lower region, then depths 1.5 and 0.5 m
  CHECK(names ==
        std::vector<std::string>{"rock", "rock", "rock", "rock", "tailings", "liquefied", "liquefied", "liquefied"});
}

TEST_CASE("bounds are open or closed as they say; all, any and none combine") {
  const Column column;
  const auto count = [&](const std::string& when) {
    const auto names = column.materials(R"([{"material": "a", "when": )" + when + R"(}, {"material": "b"}])");
    return std::count(names.begin(), names.end(), "a");
  };
  CHECK(count(R"({"depth": {"at_most": 1.5}})") == 4);
  CHECK(count(R"({"depth": {"below": 1.5}})") == 2);
  CHECK(count(R"({"depth": {"at_least": 1.5, "at_most": 2.5}})") == 4);
  CHECK(count(R"({"depth": {"above": 1.5, "at_most": 2.5}})") == 2);
  CHECK(count(R"({"x": {"below": 1.0}})") == 4);
  CHECK(count(R"({"y": {"above": 3.0}})") == 2);
  CHECK(count(R"({"initial_vertical_effective_stress": {"above": 2e4}})") == 4);
  CHECK(count(R"({"none": [{"x": {"below": 1.0}}], "all": [{"depth": {"below": 3}}, {"depth": {"above": 1}}]})") == 2);
}

TEST_CASE(
    "names of materials do not depend on the model; each point knows its law; materials without points are left out") {
  const Column column;
  const auto rules = rules_of(R"([
    {"material": "none", "when": {"depth": {"above": 99}}, "residual_strength": {"model": "constant", "strength": 5000}},
    {"material": "liquefied", "when": {"region": "lower"}, "residual_strength":
      {"model": "bins", "edges": [1e4, 2e4, 9e4], "strengths": [1000, 2000, 3000, 4000], "drained_cap": false}},
    {"material": "rock"}])");
  const Assignment found = assign(column.mesh, column.points, column.state, rules);
  CHECK(found.material_names == std::vector<std::string>{"liquefied", "rock"});
  CHECK(found.material_id == std::vector<std::int32_t>{0, 0, 0, 0, 1, 1, 1, 1});
  CHECK(found.strength_law == std::vector<std::int32_t>{1, 1, 1, 1, -1, -1, -1, -1});
  REQUIRE(found.strength_laws.size() == 2);
  CHECK(nlohmann::json::parse(found.strength_laws[1])["edges"] == nlohmann::json{1e4, 2e4, 9e4});
  REQUIRE(found.residual_strength.size() == 8);
  for (std::size_t p = 0; p < 8; ++p) CHECK(found.residual_strength[p] == (p < 4 ? 3000.0 : 0.0));
}

TEST_CASE("what was done is recorded: model, inputs, percentile, bound hits") {
  const Column column;
  const auto rules = rules_of(R"([{"material": "m", "residual_strength":
      {"model": "weber", "blow_count": 6, "percentile": 33, "friction_angle": 10}}])");
  const auto record = assign(column.mesh, column.points, column.state, rules).record;
  const auto& strength = record[0]["residual_strength"];
  CHECK(record[0]["points"] == 8);
  CHECK(strength["model"] == "weber");
  CHECK(strength["blow_count"] == 6.0);
  CHECK(strength["percentile"] == 33.0);
  CHECK(strength["capped_by_drained_strength"] == 2);  // 5 kPa tan 10 deg = 0.88 kPa under Weber's 0.99 kPa
}

TEST_CASE("points that no rule fits are an error with regions and counts") {
  const Column column;
  const auto message = example::message_of<tailrun::InputError>(
      [&] { column.materials(R"([{"material": "a", "when": {"region": "upper", "depth": {"below": 1}}}])"); });
  CHECK(message.find("4 in 'lower'") != std::string::npos);
  CHECK(message.find("2 in 'upper'") != std::string::npos);
}

TEST_CASE("a rule that fits nothing is a warning, but not when its region is left out altogether") {
  const Column column;
  const auto rules = rules_of(R"([{"material": "a", "when": {"depth": {"above": 100}}}, {"material": "b"},
                                  {"material": "c", "when": {"region": "lower"}}])");
  CHECK(assign(column.mesh, column.points, column.state, rules).warnings.size() == 2);
  std::vector<bool> upper_only(8, false);
  std::fill(upper_only.begin() + 4, upper_only.end(), true);
  const auto points = sample(column.mesh, upper_only, example::sampling(Layout::gauss, 1));
  const auto state = map_state(column.mesh, points, {});
  CHECK(assign(column.mesh, points, state, rules).warnings.size() == 1);
}

TEST_CASE("wrong rules are answered with the place and the nearest name") {
  CHECK(error_of(R"([{"material": "a", "when": {"region": "uper"}}])").find("Did you mean 'upper'?") !=
        std::string::npos);
  CHECK(error_of(R"([{"material": "a", "when": {"dept": {"below": 1}}}])").find("Did you mean 'depth'?") !=
        std::string::npos);
  CHECK(error_of(R"([{"material": "a", "when": {"depth": {"under": 1}}}])").find("/rules/0/when/depth") !=
        std::string::npos);
  CHECK(error_of(R"([{"material": "a", "when": {"depth": {"above": 2, "below": 1}}}])").find("empty") !=
        std::string::npos);
  CHECK(error_of(R"([{"when": {}}])").find("/rules/0/material: missing") != std::string::npos);
}

TEST_CASE("a bound on sigma'_v0 in kPa is warned of") {
  const auto warned = [](const char* bound) {
    tailrun::forget_warnings();
    Column().materials(std::string(R"([{"material": "a", "when": {"initial_vertical_effective_stress": )") + bound +
                       R"(}}, {"material": "b"}])");
    std::string all;
    for (const auto& text : tailrun::warnings()) all += text;
    tailrun::forget_warnings();
    return all;
  };
  CHECK(warned(R"({"above": 2e4, "at_most": 1e5})") == "");
  CHECK(warned(R"({"above": 0})") == "");
  CHECK(
      warned(R"({"at_most": 20})").find("initial_vertical_effective_stress/at_most: 20 Pa is the stress under less") !=
      std::string::npos);
}

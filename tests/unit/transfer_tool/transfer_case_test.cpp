#include "transfer_tool/options/transfer_case.hpp"

#include <doctest/doctest.h>

#include "common/error.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

const std::vector<std::string> mochikoshi_regions = {"tailings", "embankment", "foundation", "freefield_tailings",
                                                     "freefield_foundation"};

TransferCase case_of(const std::string& json, const std::string& size = {}) {
  const example::TemporaryFolder folder;
  return read_transfer_case(tailrun::CaseFile(folder.write("transfer.json", json)), mochikoshi_regions, size);
}

std::string error_of(const std::string& json) {
  return example::message_of<tailrun::InputError>([&] { case_of(json); });
}

}  // namespace

TEST_CASE("a bed's name can be a dataset's, and is no wall's") {
  const auto named = [](const std::string& name) {
    return error_of(R"({"terrain": {"regions": ["foundation"], "name": ")" + name +
                    R"("}, "rules": [{"material": "a"}]})");
  };
  CHECK(named("bed rock") == "");
  CHECK(named("a/b").find("/terrain/name: the name \"a/b\" has a slash") != std::string::npos);
  CHECK(named("").find("is empty") != std::string::npos);
  CHECK(named("upstream_wall").find("which is a wall's name") != std::string::npos);
}

TEST_CASE("a size that the case does not have is refused, with the nearest one") {
  const tailrun::CaseFile file(std::string(TAILRUN_SOURCE_DIR) + "/cases/mochikoshi/transfer.json");
  CHECK_THROWS_WITH_AS(read_transfer_case(file, mochikoshi_regions, "coarze"),
                       doctest::Contains("Did you mean 'coarse'?"), tailrun::InputError);
}

TEST_CASE("the Mochikoshi cases read without an unknown key and mean what the paper did") {
  for (const char* name : {"transfer.json", "transfer_foundation.json"}) {
    const tailrun::CaseFile file(std::string(TAILRUN_SOURCE_DIR) + "/cases/mochikoshi/" + name);
    const TransferCase wanted = read_transfer_case(file, mochikoshi_regions, "coarse");
    CAPTURE(name);
    CHECK(*wanted.transfer_time == 16.0);
    CHECK(wanted.sampling.cell_size == 2.0);
    CHECK(wanted.sampling.kept_region[2] == (std::string(name) == "transfer_foundation.json"));
    CHECK_FALSE(wanted.sampling.kept_region[3]);
    REQUIRE(wanted.rules.size() == 4);
    const tailrun::StrengthLaw& law = *wanted.rules[0].strength;
    CHECK(law.record["strengths"].size() == 5);
    CHECK(law(17e3).value == 3200.0);
    CHECK(law(186e3).value == 9100.0);
    CHECK_FALSE(law.drained_cap);
    CHECK_FALSE(wanted.state.maximum_pressure_ratio);
    CHECK(wanted.state.remove_base_motion);
  }
}

TEST_CASE("points: everywhere, by region, automatic") {
  const auto wanted = case_of(
      R"({"sampling": {"points": 2, "points_by_region": {"tailings": 4, "embankment": "automatic"}}, "rules": [{"material": "a"}]})");
  CHECK(wanted.sampling.points == std::vector<int>{4, 0, 2, 2, 2});
  CHECK(case_of(R"({"rules": [{"material": "a"}]})").sampling.points == std::vector<int>(5, 0));
}

TEST_CASE("wrong keys, regions and values are answered with the place and the nearest name") {
  const std::string rules = R"("rules": [{"material": "a"}]})";
  CHECK(error_of(R"({"samplng": {}, )" + rules).find("Did you mean 'sampling'?") != std::string::npos);
  CHECK(error_of(R"({"exclude": ["foundatoin"], )" + rules).find("Did you mean 'foundation'?") != std::string::npos);
  CHECK(error_of(R"({"sampling": {"points_by_region": {"tailing": 2}}, )" + rules).find("Did you mean 'tailings'?") !=
        std::string::npos);
  CHECK(error_of(R"({"sampling": {"points": 6}, )" + rules).find("/sampling/points") != std::string::npos);
  CHECK(error_of(R"({"clip": {"x": [5, 1]}, )" + rules).find("/clip/x") != std::string::npos);
  CHECK(error_of(R"({"terrain": {"regions": []}, )" + rules).find("/terrain/regions") != std::string::npos);
  CHECK(error_of(R"({"rules": []})").find("/rules") != std::string::npos);
  CHECK(error_of("{\"rules\": [").find("not valid JSON") != std::string::npos);
  CHECK_THROWS_AS(tailrun::CaseFile("no_such_transfer.json"), tailrun::InputError);
}

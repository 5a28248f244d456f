#include "transfer_tool/assign/strength_law.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/error.hpp"
#include "example_mesh.hpp"
#include "transfer_tool/assign/residual_strength.hpp"

using namespace tailrun::transfer;

namespace {

StrengthLaw law_of(const std::string& json) {
  const example::TemporaryFolder folder;
  const tailrun::CaseFile file(folder.write("law.json", json));
  StrengthLaw law = read_strength_law(file.root());
  file.finish();
  return law;
}

std::string error_of(const std::string& json) {
  return example::message_of<tailrun::InputError>([&] { law_of(json); });
}

}  // namespace

TEST_CASE("the drained strength caps s_R, and the cap is reported") {
  const auto law = law_of(R"({"model": "constant", "strength": 5000, "friction_angle": 34, "minimum_strength": 1})");
  const Strength shallow = law(4e3), deep = law(50e3);
  CHECK(shallow.is_capped);
  CHECK(shallow.value == doctest::Approx(4e3 * std::tan(34.0 * M_PI / 180.0)).epsilon(1e-12));
  CHECK_FALSE(deep.is_capped);
  CHECK(deep.value == 5000.0);
  CHECK(law_of(R"({"model": "constant", "strength": 5000, "drained_cap": false})")(4e3).value == 5000.0);
}

TEST_CASE("a strength below the lower bound is raised to it, also where there is no stress at all") {
  const auto law = law_of(R"({"model": "weber", "blow_count": 2, "percentile": 16, "minimum_ratio": 0.02})");
  const Strength low = law(17e3);  // Weber's 16th percentile is negative here
  CHECK(low.is_raised);
  CHECK(low.value == doctest::Approx(340.0));
  CHECK(law(0.0).value == 200.0);
  CHECK(law(-3e3).value == 200.0);
}

TEST_CASE("a table is linear between its rows and constant beyond, with a flag") {
  const auto law = law_of(
      R"({"model": "table", "initial_vertical_effective_stress": [1e4, 3e4], "strength": [2000, 4000], "drained_cap": false})");
  CHECK(law(2e4).value == doctest::Approx(3000.0));
  CHECK(law(2.5e4).value == doctest::Approx(3500.0));
  CHECK_FALSE(law(2e4).is_outside);
  CHECK(law(5e4).value == 4000.0);
  CHECK(law(5e4).is_outside);
  CHECK(law(1e3).value == 2000.0);
}

TEST_CASE("bins take the strength between their inner edges") {
  const auto law =
      law_of(R"({"model": "bins", "edges": [1e4, 2e4], "strengths": [1000, 2000, 3000], "drained_cap": false})");
  CHECK(law(5e3).value == 1000.0);
  CHECK(*law(5e3).bin == 0);
  CHECK(*law(1e4).bin == 1);
  CHECK(*law(9e4).bin == 2);
  CHECK(law(9e4).value == 3000.0);
}

TEST_CASE("models reach their correlations, with percentile and factor") {
  const double z = standard_normal_quantile(0.33);
  CHECK(law_of(R"({"model": "weber", "blow_count": 6, "percentile": 33, "factor": 0.5})")(1e5).value ==
        doctest::Approx(0.5 * weber_2015(6, 1e5, z)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "kramer_wang", "blow_count": 6, "percentile": 33})")(1e5).value ==
        doctest::Approx(kramer_wang_2015(6, 1e5, z)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "olson_stark", "blow_count": 6, "percentile": 33})")(1e5).value ==
        doctest::Approx(1e5 * olson_stark_spt_ratio(6, z)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "idriss_boulanger", "blow_count": 4, "fines_content": 50})")(1e5).value ==
        doctest::Approx(1e5 * idriss_boulanger_spt_ratio(8, true)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "idriss_boulanger", "cone_resistance": 80, "void_redistribution": false})")(1e5).value ==
        doctest::Approx(1e5 * idriss_boulanger_cpt_ratio(80, false)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "seed_fit"})")(1e5).value == doctest::Approx(seed_fit(6, 1e5)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "robertson_2022", "cone_resistance": 50})")(1e5).value ==
        doctest::Approx(1e5 * robertson_2022_ratio(50)).epsilon(1e-14));
  CHECK(law_of(R"({"model": "ratio", "ratio": 0.08})")(1e5).value == doctest::Approx(8e3));
}

TEST_CASE("inputs outside of the case histories are warned about") {
  CHECK(law_of(R"({"model": "weber", "blow_count": 25})").warnings.size() == 1);
  CHECK(law_of(R"({"model": "weber", "blow_count": 6})").warnings.empty());
  CHECK(law_of(R"({"model": "weber", "blow_count": 6})")(600e3).is_outside);
  CHECK(law_of(R"({"model": "olson_stark", "cone_resistance": 8e6})").warnings.size() == 1);
}

TEST_CASE("wrong input is answered with the place and what is allowed") {
  CHECK(error_of(R"({"model": "webber", "blow_count": 6})").find("Did you mean 'weber'?") != std::string::npos);
  CHECK(error_of(R"({"model": "weber"})").find("/blow_count: missing") != std::string::npos);
  CHECK(error_of(R"({"model": "weber", "blow_count": 6, "percentil": 33})").find("Did you mean 'percentile'?") !=
        std::string::npos);
  CHECK(error_of(R"({"model": "bins", "edges": [1], "strengths": [1, 2, 3]})").find("2 inner edges") !=
        std::string::npos);
  CHECK(error_of(R"({"model": "bins", "edges": [2, 1], "strengths": [1, 2, 3]})").find("increase") !=
        std::string::npos);
  CHECK(error_of(R"({"model": "idriss_boulanger", "blow_count": 6, "percentile": 33})").find("unknown key") !=
        std::string::npos);
}

#include "common/residual_strength/strength_law.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "common/residual_strength/relations.hpp"

using namespace tailrun;

namespace {

template <class Read>
StrengthLaw read_law(const std::string& json, Read read) {
  const auto path = std::filesystem::temp_directory_path() / ("tailrun_law_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << json;
  const CaseFile file(path);
  std::filesystem::remove(path);
  StrengthLaw law = read(file.root());
  file.finish();
  return law;
}

StrengthLaw law_of(const std::string& json) {
  return read_law(json, [](const CaseNode& node) { return read_strength_law(node); });
}

// The law that `json` makes of the one of `before` ("" : none), as it went through a particles file.
StrengthLaw changed(const std::string& json, const std::string& before) {
  KeptStrengthLaw kept{{}, "p.h5 holds no law"};
  if (!before.empty()) kept = {nlohmann::ordered_json::parse(law_of(before).record.dump()), "p.h5, row 0"};
  return read_law(json, [&kept](const CaseNode& node) { return read_changed_strength_law(node, kept); });
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string error_of(const std::string& json) {
  return message_of([&] { law_of(json); });
}

std::string error_of_change(const std::string& json, const std::string& before) {
  return message_of([&] { changed(json, before); });
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
  CHECK(law(1e4).value == 2000.0);
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

TEST_CASE("the law of the hand-over, asked for again, is the same to the last bit") {
  for (const std::string law :
       {R"({"model": "weber", "blow_count": 6.1, "percentile": 33, "factor": 0.83, "friction_angle": 31})",
        R"({"model": "kramer_wang", "blow_count": 5, "percentile": 16, "minimum_ratio": 0.031})",
        R"({"model": "olson_stark", "cone_resistance": 2.2e6, "percentile": 40, "drained_cap": false})",
        R"({"model": "idriss_boulanger", "blow_count": 7, "fines_content": 33, "void_redistribution": false})",
        R"({"model": "idriss_boulanger", "cone_resistance": 71, "blow_count": 7})",
        R"({"model": "robertson_2010", "cone_resistance": 44})", R"({"model": "seed_fit", "blow_count": 7})",
        R"({"model": "bins", "edges": [1e4, 2e4], "strengths": [1000, 2000, 3000], "drained_cap": false})",
        R"({"model": "table", "initial_vertical_effective_stress": [1e4, 3e4], "strength": [2000, 4000]})",
        R"({"model": "ratio", "ratio": 0.1})", R"({"model": "constant", "strength": 4321.1})"}) {
    const StrengthLaw before = law_of(law), nothing_said = changed("{}", law),
                      named = changed(R"({"model": ")" + before.model + "\"}", law);
    CAPTURE(before.model);
    for (double sigma = 0.0; sigma < 5e5; sigma += 1234.5) {
      CHECK(nothing_said(sigma).value == before(sigma).value);
      CHECK(named(sigma).value == before(sigma).value);
    }
    CHECK(named.record == before.record);
  }
}

TEST_CASE("another percentile leaves the rest of the law") {
  const std::string before = R"({"model": "weber", "blow_count": 8, "factor": 0.9, "drained_cap": false})";
  CHECK(changed(R"({"percentile": 16})", before)(1e5).value ==
        doctest::Approx(0.9 * weber_2015(8, 1e5, standard_normal_quantile(0.16))).epsilon(1e-14));
}

TEST_CASE("another model takes what does not depend on the model, but no factor") {
  const StrengthLaw law = changed(R"({"model": "weber"})",
                                  R"({"model": "bins", "edges": [1e4], "strengths": [1000, 2000], "factor": 0.5,
                                      "drained_cap": false, "minimum_strength": 55, "blow_count": 6})");
  CHECK(law(1e5).value == doctest::Approx(weber_2015(6, 1e5)).epsilon(1e-14));
  CHECK_FALSE(law.drained_cap);
  CHECK(law.minimum_strength == 55.0);
  CHECK(law.warnings.empty());
  const StrengthLaw other =
      changed(R"({"model": "olson_stark"})", R"({"model": "weber", "blow_count": 6, "percentile": 33})");
  CHECK(other(1e5).value == doctest::Approx(1e5 * olson_stark_spt_ratio(6, standard_normal_quantile(0.33))));
  REQUIRE(other.warnings.size() == 1);  // (N1)60cs is not (N1)60
  CHECK(other.warnings[0].find("was meant as (N1)60cs (weber), olson_stark takes (N1)60") != std::string::npos);
}

TEST_CASE("a cone resistance passes on only to a model that means the same by it") {
  const std::string stark = R"({"model": "olson_stark", "cone_resistance": 2e6})";
  CHECK(error_of_change(R"({"model": "robertson_2022"})", stark).find("/cone_resistance: missing") !=
        std::string::npos);
  CHECK(changed(R"({"model": "robertson_2022"})", R"({"model": "robertson_2010", "cone_resistance": 50})")(1e5).value ==
        doctest::Approx(1e5 * robertson_2022_ratio(50)));
}

TEST_CASE("a change that cannot be read says why") {
  CHECK(error_of_change(R"({"model": "weber"})", R"({"model": "constant", "strength": 5000})")
            .find("the law of the hand-over ('constant') has none that it could take") != std::string::npos);
  CHECK(error_of_change(R"({"percentile": 33})", "").find("/model: missing: p.h5 holds no law") != std::string::npos);
  CHECK(error_of_change(R"({"model": "weber"})", "").find("/blow_count: missing") != std::string::npos);
  CHECK(error_of_change(R"({"model": "weber", "blow_count": 6, "edges": [1]})", "").find("unknown key 'edges'") !=
        std::string::npos);
  const auto altered = [](const char* key, const nlohmann::ordered_json& value) {
    KeptStrengthLaw kept{law_of(R"({"model": "weber", "blow_count": 6})").record, "p.h5, row 0"};
    kept.record[key] = value;
    return message_of(
        [&] { read_law("{}", [&kept](const CaseNode& node) { return read_changed_strength_law(node, kept); }); });
  };
  CHECK(altered("blow_count", 99).find("p.h5, row 0: 'blow_count' is 99") != std::string::npos);
  CHECK(altered("drained_cap", 1).find("true or false") != std::string::npos);
  CHECK(altered("factor", -1).find("above 0") != std::string::npos);
  CHECK(altered("model", "webber").find("'webber' is not known") != std::string::npos);
}

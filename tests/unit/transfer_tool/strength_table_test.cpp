#include "transfer_tool/assign/strength_table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "common/error.hpp"
#include "common/residual_strength/relations.hpp"
#include "example_mesh.hpp"

using namespace tailrun;
using namespace tailrun::transfer;

namespace {

std::vector<StrengthCurve> curves_of(const std::string& rules) {
  const example::TemporaryFolder folder;
  const CaseFile file(
      folder.write("transfer.json", R"({"transfer_time": 16, "exclude": ["left"], "rules": )" + rules + "}"));
  return strength_curves(file, {33.0, 50.0});
}

const StrengthCurve& curve(const std::vector<StrengthCurve>& curves, const std::string& relation,
                           double percentile = 0.0) {
  const auto found = std::find_if(curves.begin(), curves.end(), [&](const StrengthCurve& c) {
    return !c.chosen && c.relation == relation && c.percentile.value_or(0.0) == percentile;
  });
  REQUIRE(found != curves.end());
  return *found;
}

const std::string bins = R"([{"material": "soft, wet", "when": {"region": "pond"}, "residual_strength":
    {"model": "bins", "edges": [5e4], "strengths": [3000, 6000], "drained_cap": false, "factor": 0.5, "blow_count": 6}},
    {"material": "rest"}])";

}  // namespace

TEST_CASE("beside a rule's own law stand the models that its soil data suffice for, without its factor") {
  const auto curves = curves_of(bins);
  CHECK(curves.front().chosen);
  CHECK(curves.front().law(1e5).value == 3000.0);
  CHECK(curve(curves, "weber", 33).law(1e5).value ==
        doctest::Approx(weber_2015(6, 1e5, standard_normal_quantile(0.33))));
  CHECK(curve(curves, "kramer_wang", 50).law(1e5).value == doctest::Approx(kramer_wang_2015(6, 1e5)));
  CHECK(curve(curves, "seed_fit").law(1e5).value == doctest::Approx(seed_fit(6, 1e5)));
  CHECK(std::none_of(curves.begin(), curves.end(), [](const auto& c) { return c.relation.starts_with("robertson"); }));
}

TEST_CASE("both readings of Idriss & Boulanger are there, and cone resistances go to models that mean them") {
  const auto curves = curves_of(R"([{"material": "m", "residual_strength":
      {"model": "idriss_boulanger", "cone_resistance": 80}}])");
  CHECK(curve(curves, "idriss_boulanger, void redistribution").law(1e5).value ==
        doctest::Approx(1e5 * idriss_boulanger_cpt_ratio(80, true)));
  CHECK(curve(curves, "idriss_boulanger, negligible redistribution").law(1e5).value ==
        doctest::Approx(1e5 * idriss_boulanger_cpt_ratio(80, false)));
  CHECK(curves.size() == 3);
}

TEST_CASE("table and CSV say the same, and what a bound has made") {
  const auto curves =
      curves_of(R"([{"material": "soft, wet", "residual_strength": {"model": "constant", "strength": 5000}}])");
  REQUIRE(curves.size() == 1);
  CHECK(strength_text(curves, 20e3).find("5.00 ") != std::string::npos);
  std::istringstream csv(strength_csv(curves, 20e3, 3));
  std::string line;
  std::getline(csv, line);
  std::getline(csv, line);
  CHECK(line == R"(0,"soft, wet","constant",,1,0,200,1,1,0)");  // capped at nothing, raised to the least
  std::getline(csv, line);
  CHECK(line == R"(0,"soft, wet","constant",,1,10000,5000,0,0,0)");
}

TEST_CASE("only the strengths are read, and they are checked") {
  const auto message = [](const std::string& rules) {
    return example::message_of<InputError>([&] { curves_of(rules); });
  };
  CHECK(message(R"([{"material": "a"}])").find("no rule has a residual_strength") != std::string::npos);
  CHECK(message(R"([{"material": "a", "residual_strength": {"model": "weber", "blow_count": 6, "percentil": 3}}])")
            .find("Did you mean 'percentile'?") != std::string::npos);
}

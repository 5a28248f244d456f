// The element driver and the calibration, through their files.
#include <doctest/doctest.h>
#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "fem_stage/element_test/calibration.hpp"
#include "fem_stage/element_test/element_test.hpp"
#include "fem_stage/element_test/element_test_case.hpp"
#include "material_drive.hpp"

using namespace tailrun;
using namespace tailrun::fem;
using namespace tailrun::fem::testing;
namespace fs = std::filesystem;

namespace {

const std::string tailings_json =
    R"("material": {"model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 2.7, "Q": 11.998, "R": 3.75,
                    "density": 1870})";

fs::path folder() {
  const fs::path path = fs::temp_directory_path() / "tailrun_element_test";
  fs::create_directories(path);
  return path;
}
fs::path written(const std::string& text) {
  std::ofstream(folder() / "test.json") << text;
  return folder() / "test.json";
}
nlohmann::json run(const std::string& text) {
  run_element_test({written(text), folder() / "out.csv", folder() / "summary.json"});
  return nlohmann::json::parse(std::ifstream(folder() / "summary.json"));
}

}  // namespace

TEST_CASE("element test: cyclic simple shear writes the columns and the summary") {
  const auto summary = run("{" + tailings_json + R"(, "initial": {"vertical_effective_stress": 1.0e5, "K0": 0.5},
      "loading": {"type": "cyclic_simple_shear", "drainage": "constant_volume", "csr": 0.1,
                  "shear_strain_increment": 5e-6}, "stop": {"cycles": 50, "shear_strain": 0.06}})");
  std::ifstream csv(folder() / "out.csv");
  std::string header;
  std::getline(csv, header);
  CHECK(header ==
        "step,cycle,shear_strain,shear_stress,vertical_effective_stress,mean_effective_stress,"
        "excess_pore_pressure_ratio,volumetric_strain");
  CHECK(summary.at("cycles_to_shear_strain_0.03").get<double>() == doctest::Approx(9.190).epsilon(0.003));
  CHECK(summary.at("cycles_to_ru_0.98").is_null());
  CHECK(summary.at("peak_shear_stress").get<double>() == doctest::Approx(10e3).epsilon(0.002));
  for (const char* key :
       {"cycles_to_ru_0.95", "cycles_to_shear_strain_0.01", "shear_stress_at_strain", "updates", "seconds"}) {
    CHECK(summary.contains(key));
  }
}

// With K_f = 2.2 GPa the water's compressibility delays liquefaction by half a cycle (reference: 9.220 against 8.725).
TEST_CASE("element test: undrained with a compressible pore fluid") {
  ElementTestCase test;
  test.material = {"loose", loose()};
  test.drainage = Drainage::undrained;
  test.porosity = 0.695 / 1.695;
  test.csr = 0.10;
  test.stop_strain = 0.05;
  for (const auto& [bulk, cycles] : {std::pair{2.2e9, 9.220}, std::pair{2.2e11, 8.7248}}) {
    test.fluid_bulk_modulus = bulk;
    CHECK(simulate(test).cycles_to_strain_3.value() == doctest::Approx(cycles).epsilon(0.003));
  }
}

TEST_CASE("element test: a strain path given as legs follows the mixed path of OpenSees' material") {
  const auto summary = run(R"({"material": {"model": "pm4sand", "relative_density": 0.55, "G0": 677, "hpo": 0.4,
      "density": 1690, "compatibility": "opensees"}, "initial": {"vertical_effective_stress": 1e5, "K0": 0.5},
      "loading": {"type": "strain_path", "path": [{"increment": [0, 2e-6, 4e-6], "repeats": 500},
                                                  {"increment": [0, 1e-6, -1e-5], "repeats": 1000}]}})");
  CHECK(summary.at("final").at("shear_stress").get<double>() == doctest::Approx(-181.876e3).epsilon(1e-3));
  CHECK(summary.at("final").at("vertical_effective_stress").get<double>() == doctest::Approx(533.349e3).epsilon(1e-3));
  CHECK(summary.at("final").at("volumetric_strain").get<double>() == doctest::Approx(0.002));
}

TEST_CASE("element test: drained compression of Mohr-Coulomb soil ends at its strength") {
  const auto summary = run(R"({"material": {"model": "mohr_coulomb", "shear_modulus": 2e7, "cohesion": 5e3,
      "friction_angle": 30, "density": 1800}, "initial": {"vertical_effective_stress": 1e5, "K0": 1.0},
      "loading": {"type": "plane_strain_compression", "drainage": "drained", "axial_strain_increment": 1e-4},
      "stop": {"axial_strain": 0.05}})");
  const double expected = 100e3 * 3.0 + 2.0 * 5e3 * std::sqrt(3.0);  // sigma_3 N + 2 c sqrt(N), N = 3
  CHECK(summary.at("final").at("vertical_effective_stress").get<double>() == doctest::Approx(expected).epsilon(1e-4));
}

TEST_CASE("element test: linear elastic simple shear is G gamma") {
  const auto summary = run(R"({"material": {"model": "linear_elastic", "shear_modulus": 3e7, "density": 1800},
      "loading": {"type": "monotonic_simple_shear", "shear_strain_increment": 1e-4}, "stop": {"shear_strain": 0.01}})");
  CHECK(summary.at("final").at("shear_stress").get<double>() == doctest::Approx(3e5));
}

TEST_CASE("element test: unknown keys, types and missing amplitudes are refused") {
  CHECK_THROWS_AS(run("{" + tailings_json + R"(, "loading": {"type": "triaxial"}})"), InputError);
  CHECK_THROWS_AS(run("{" + tailings_json + R"(, "loading": {"type": "cyclic_simple_shear"}})"), InputError);
  CHECK_THROWS_AS(run("{" + tailings_json + R"(, "loading": {"type": "cyclic_simple_shear", "csr": 0.1, "csrr": 1}})"),
                  InputError);
}

TEST_CASE("element test: a stress in kPa is warned of, a cyclic stress ratio in % refused") {
  forget_warnings();
  const auto read = [](const std::string& stress, const std::string& csr) {
    read_element_test(written("{" + tailings_json + R"(, "initial": {"vertical_effective_stress": )" + stress +
                              R"(}, "loading": {"type": "cyclic_simple_shear", "csr": )" + csr + "}}"));
  };
  read("100000", "0.12");
  CHECK(warnings().empty());
  read("100", "0.12");
  REQUIRE(warnings().size() == 1);
  CHECK(warnings()[0].find("/initial/vertical_effective_stress: 100 Pa is the stress under less than a tenth") !=
        std::string::npos);
  CHECK_THROWS_WITH_AS(read("100000", "12"), doctest::Contains("12 % are 0.12"), InputError);
  forget_warnings();
}

// Targets computed from known parameters must lead back to them.
TEST_CASE("calibration: finds h_po and Q again from the strengths they give") {
  ElementTestCase strength;
  strength.material = {"", tailings()};
  strength.type = ElementTestType::monotonic_simple_shear;
  strength.strain_increment = 1e-4;
  strength.stop_strain = 0.1;
  std::string targets;
  for (const double vertical : {17e3, 186e3}) {
    strength.vertical_effective_stress = vertical;
    if (!targets.empty()) targets += ", ";
    targets += fmt::format("{{\"vertical_effective_stress\": {}, \"shear_stress\": {}}}", vertical,
                           simulate(strength).rows.back().shear_stress);
  }
  ElementTestCase cyclic;
  cyclic.material = {"", tailings()};
  cyclic.csr = 0.09;
  cyclic.stop_strain = 0.03;
  const double cycles = simulate(cyclic).cycles;
  const auto file = written(R"({"material": {"model": "pm4sand", "relative_density": 0.35, "G0": 476, "hpo": 1.0,
      "Q": 11.0, "R": 3.75, "density": 1870}, "cyclic_strength": {"csr": 0.09, "cycles": )" +
                            std::to_string(cycles) + R"(}, "residual_strength": {"shear_strain": 0.1, "targets": [)" +
                            targets + "]}}");
  run_calibration({file, folder() / "calibration"});
  const auto found = nlohmann::json::parse(std::ifstream(folder() / "calibration" / "calibration.json"));
  CHECK(found.at("Q").get<double>() == doctest::Approx(11.998).epsilon(1e-3));
  CHECK(found.at("hpo").get<double>() == doctest::Approx(2.7).epsilon(0.03));
  for (const char* name : {"cyclic_strength.csv", "residual_strength.csv", "calibration.svg"}) {
    CHECK(fs::file_size(folder() / "calibration" / name) > 100);
  }
  const auto& block = found.at("materials").at("calibrated");
  CHECK(block.at("hpo") == found.at("hpo"));
  CHECK(block.at("G0") == 476);
  CHECK(!found.contains("asked_for_alone"));
}

TEST_CASE("calibration: targets that conflict leave what was reached and what each asks for") {
  const auto file = written(R"({"material": {"model": "pm4sand", "relative_density": 0.4, "hpo": 0.5, "density": 1930},
      "cyclic_strength": {"csr": 0.17}, "residual_strength": {"shear_strain": 0.2,
      "targets": [{"vertical_effective_stress": 100e3, "shear_stress": 14e3}]}})");
  std::string message;
  try {
    run_calibration({file, folder() / "conflict"});
  } catch (const ComputationError& error) {
    message = error.what();
  }
  CHECK(message.find("cannot be met together") != std::string::npos);
  CHECK(message.find("the cyclic strength alone asks for hpo = 5.6") != std::string::npos);
  const auto found = nlohmann::json::parse(std::ifstream(folder() / "conflict" / "calibration.json"));
  CHECK(found.at("reached").at("cyclic_strength") == true);
  CHECK(found.at("reached").at("residual_strength") == false);
  CHECK(found.at("cyclic_strength").at("cycles").get<double>() == doctest::Approx(15.0).epsilon(0.03));
  CHECK(found.at("asked_for_alone").at("cyclic_strength").at("hpo").get<double>() ==
        doctest::Approx(5.65).epsilon(0.01));
  double nearest = 10.0;
  for (const auto& row : found.at("by_Q"))
    nearest = std::min(nearest, std::abs(std::log(row.at("residual_over_target").get<double>())));
  const auto& strength = found.at("residual_strength").at(0);
  CHECK(std::abs(std::log(strength.at("shear_stress").get<double>() / strength.at("target").get<double>())) ==
        doctest::Approx(nearest));
  CHECK(found.at("materials").at("calibrated").at("relative_density") == 0.4);
}

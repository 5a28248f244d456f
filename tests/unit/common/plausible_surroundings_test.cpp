// Gravity, water and rock that cannot be meant are said, with the likely unit; what can be meant is not.
#include "common/plausible_surroundings.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <fstream>
#include <functional>

#include "common/error.hpp"
#include "common/warnings.hpp"

using namespace tailrun;

namespace {

// The error ("error: ..."), or else the warnings, of reading `text` as a case file by `action`.
std::string said(const std::string& text, const std::function<void(const CaseNode&)>& action) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_surroundings.json";
  std::ofstream(path) << text;
  const CaseFile file(path);
  forget_warnings();
  std::string words;
  try {
    action(file.root());
    for (const auto& warning : warnings()) words += warning + "\n";
  } catch (const InputError& error) {
    words = std::string("error: ") + error.what();
  }
  forget_warnings();
  return words;
}

std::string said_of_gravity(const std::string& value) {
  return said("{\"gravity\": " + value + "}",
              [](const CaseNode& root) { read_gravity(root, Range::non_negative(), 9.81); });
}

std::string said_of_water(double density, double gravity = 9.81) {
  return said("{}", [&](const CaseNode& root) { check_fluid_density(root, "density", density, gravity); });
}

std::string said_of_permeability(const std::vector<double>& values, double gravity = 9.81) {
  return said("{}", [&](const CaseNode& root) { check_permeability(root, "permeability", values, gravity); });
}

std::string said_of_rock(const std::string& keys) {
  return said("{" + keys + "}", [](const CaseNode& root) { check_dashpot_soil(root, "rock_", 9.81); });
}

std::string said_of_line(const std::string& line) {
  return said("{\"phreatic_line\": " + line + "}", [](const CaseNode& root) { read_phreatic_line(root); });
}

}  // namespace

TEST_CASE("gravity: of the earth or none in silence, in another unit a warning, upwards or a vector an error") {
  for (const char* meant : {"9.81", "9.80665", "10", "0"}) CHECK(said_of_gravity(meant) == "");
  CHECK(said_of_gravity("32.2").find("/gravity: 32.2 m/s2; 32.2 ft/s2 are 9.818 m/s2") != std::string::npos);
  CHECK(said_of_gravity("981").find("981 cm/s2 are 9.81 m/s2") != std::string::npos);
  CHECK(said_of_gravity("1").find("1 g are 9.81 m/s2") != std::string::npos);
  CHECK(said_of_gravity("490.5").find("50 times that of the earth") != std::string::npos);
  CHECK(said_of_gravity("-9.81").starts_with("error: "));
  CHECK(said_of_gravity("-9.81").find("upwards; is it 9.81?") != std::string::npos);
  CHECK(said_of_gravity("[-9.81, 0]").find("found a list, but one number is required") != std::string::npos);
}

TEST_CASE("water's density: g/cm3 and kN/m3 are errors, lb/ft3 and what is too light or heavy warnings") {
  for (const double meant : {1000.0, 998.2, 1025.0, 1200.0}) CHECK(said_of_water(meant) == "");
  CHECK(said_of_water(1.0).starts_with("error: "));
  CHECK(said_of_water(1.0).find("1 g/cm3 are 1000 kg/m3") != std::string::npos);
  CHECK(said_of_water(9.81).find("9.81 kN/m3 are 1000 kg/m3") != std::string::npos);
  CHECK(said_of_water(62.4).find("62.4 lb/ft3 are 999.6 kg/m3") != std::string::npos);
  CHECK(said_of_water(1900.0).find("no density of water") != std::string::npos);
  CHECK(said_of_water(1.0, 0.0) == "");
}

TEST_CASE("permeability: faster than gravel is an error, as fast as it a warning, both with other units") {
  CHECK(said_of_permeability({0.02, 0.0}) == "");
  CHECK(said_of_permeability({1e-6, 1e3}).starts_with("error: "));
  CHECK(said_of_permeability({1e3}).find("1000 m/day are 0.0116 m/s") != std::string::npos);
  CHECK(said_of_permeability({0.5}).find("0.5 cm/s are 0.005 m/s") != std::string::npos);
  CHECK(said_of_permeability({1e3}, 0.0) == "");
}

TEST_CASE("rock beyond the edge: density in g/cm3 is an error, waves in km/s a warning") {
  CHECK(said_of_rock(R"("rock_density": 2500, "rock_shear_velocity": 700)") == "");
  CHECK(said_of_rock(R"("rock_density": 2.5)").find("2.5 g/cm3 are 2500 kg/m3") != std::string::npos);
  CHECK(said_of_rock(R"("rock_density": 2.5)").starts_with("error: "));
  CHECK(said_of_rock(R"("rock_shear_velocity": 0.7)").find("0.7 km/s are 700 m/s") != std::string::npos);
}

TEST_CASE("rock beyond the edge: too fast, too dense, its waves exchanged") {
  const auto rock = [](double density, double shear, double p) {
    return said_of_rock(
        fmt::format(R"("rock_density": {}, "rock_shear_velocity": {}, "rock_p_velocity": {})", density, shear, p));
  };
  CHECK(rock(3300, 4500, 8000) == "");
  CHECK(rock(1900, 200, 374) == "");
  CHECK(rock(2500, 700000, 1.3e6).find("700000 mm/s are 700 m/s") != std::string::npos);
  CHECK(rock(2500, 700, 1.3e6).find("/rock_p_velocity: 1.3e+06 m/s is faster") != std::string::npos);
  CHECK(rock(2.5e6, 700, 1300).find("2.5e+06 g/m3 are 2500 kg/m3") != std::string::npos);
  CHECK(rock(2500, 1300, 700).find("are they exchanged?") != std::string::npos);
}

TEST_CASE("a phreatic line ascends in x") {
  CHECK(said_of_line("[[-1, 5], [0, 5]]") == "");
  CHECK(said_of_line("[[0, 5], [10, 4], [3, 2]]").find("row 2: found x = 3 m after 10 m") != std::string::npos);
  CHECK(said_of_line("[[0, 5], [0, 4]]").starts_with("error: "));
}

// What is said of a model that can be computed and cannot be meant: entries that are there twice, pressures and
// stiffness of another unit.
#include <doctest/doctest.h>

#include "common/warnings.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/model/own_weight.hpp"
#include "small_case.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

// The error, or else the warnings, of a model of 4 x 4 m with these keys, whose soil has this stiffness (Pa).
std::string said_of_model(const std::string& more, const std::string& boundaries = "",
                          const std::string& stiffness = "1e7") {
  const auto path = case_file(R"("duration": 1)", more);
  std::ifstream file(path);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  file.close();
  text.insert(text.find(R"("roller_lines")"), boundaries);
  text.replace(text.find("1e7"), 3, stiffness);
  std::ofstream(path) << text;
  forget_warnings();
  const std::string error = refusal([&] {
    const FemCase options = read_fem_case(path, "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "tailrun_requests.msh");
    check_own_weight(CaseFile(path).root(), build_model(options, folder / "tailrun_requests.msh"));
  });
  std::string all;
  for (const auto& text_of : warnings()) all += text_of;
  forget_warnings();
  return error.empty() ? all : "error: " + error;
}

}  // namespace

TEST_CASE("a load that is there twice is warned of, free-field dashpots that are refused") {
  const auto loads = [](const std::string& second) {
    return said_of_model(R"("loads": [{ "line": "top", "pressure": 1e4 }, )" + second + "],");
  };
  CHECK(loads(R"({ "line": "top", "pressure": 1e4 })").find("/loads/1: is the same as /loads/0: both act") !=
        std::string::npos);
  CHECK(loads(R"({ "line": "top", "pressure": 1e4, "stage": "shake" })").find("is doubled") != std::string::npos);
  for (const char* other :
       {R"({ "line": "top", "pressure": 2e4 })", R"({ "line": "left", "pressure": 1e4 })",
        R"({ "line": "top", "traction": [1e4, 0] })",
        R"({ "line": "top", "pressure": 1e4, "stage": "shake", "history": { "type": "ramp", "duration": 1 } })"})
    CHECK_MESSAGE(loads(other) == "", other);
  CHECK(said_of_model(R"("loads": [{ "line": "top", "pressure": 1e4, "stage": "geostatic" },
                                   { "line": "top", "pressure": 1e4, "stage": "shake" }],)") == "");
  const std::string side = R"({ "line": "left", "column_line": "right" })";
  CHECK(said_of_model("", R"("free_field_dashpots": [)" + side + ", " + side + "], ")
            .find("line 'left' has dashpots already (/boundaries/free_field_dashpots/0)") != std::string::npos);
}

TEST_CASE("a line's pore pressure is held at one value") {
  const auto held = [](const std::string& drained, const std::string& first, const std::string& second) {
    return said_of_model("", R"("drained_lines": [)" + drained +
                                 R"(], "held_pressure": [{ "line": "top", "pressure": )" + first +
                                 R"( }, { "line": "top", "pressure": )" + second + " }], ");
  };
  CHECK(held("", "[2e4]", "[1e4]")
            .find("/boundaries/held_pressure/1: line 'top' is held at another pore pressure already "
                  "(/boundaries/held_pressure/0)") != std::string::npos);
  CHECK(held(R"("top")", "[1e4]", "[1e4]").find("/boundaries/held_pressure/0: line 'top' is held at another") !=
        std::string::npos);
  CHECK(held("", "[1e4]", "[1e4]").find("error") == std::string::npos);
}

TEST_CASE("held pressures and loads in kPa, and those that were multiplied once too often") {
  const auto held = [](const std::string& field) {
    return said_of_model("", R"("held_pressure": [{ "line": "top", "pressure": )" + field + " }], ");
  };
  CHECK(held("[0]") == "");
  CHECK(held("[300]") == "");
  CHECK(held("[2e5]") == "");
  CHECK(held("[50]").find("/boundaries/held_pressure/0/pressure: at most 50 Pa on line 'top' is next to nothing") !=
        std::string::npos);
  CHECK(held("[50]").find("50 kPa are 5e+04 Pa") != std::string::npos);
  CHECK(held("[79.2, 0, -9.81]").find("next to nothing") != std::string::npos);
  CHECK(held("[5e7]").find("is it 5e+04 Pa?") != std::string::npos);
  const auto load = [](const std::string& pressure) {
    return said_of_model(R"("loads": [{ "line": "top", "pressure": )" + pressure + "}],");
  };
  CHECK(load("500") == "");
  CHECK(load("20").find("/loads/0: 20 Pa on line 'top' is next to nothing beside the weight of 4 m of soil") !=
        std::string::npos);
  CHECK(load("5e7").find("is it 5e+04 Pa?") != std::string::npos);
}

TEST_CASE("stiffness is weighed with the height of the mesh, also where it comes from a file or geometry") {
  const auto of_mesh_file = [](const std::string& stiffness) {
    const auto path = case_file(R"("duration": 1)");
    write_rectangle_mesh(*read_fem_case(path, "").mesh.rectangle, folder / "tailrun_requests.msh");
    std::ifstream file(path);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    file.close();
    const auto rectangle = text.find(R"("rectangle")");
    text.replace(rectangle, text.find('}', rectangle) + 1 - rectangle, R"("file": "tailrun_requests.msh")");
    text.replace(text.find("1e7"), 3, stiffness);
    std::ofstream(path) << text;
    forget_warnings();
    const FemCase options = read_fem_case(path, "");
    check_own_weight(CaseFile(path).root(), build_model(options, folder / "tailrun_requests.msh"));
    std::string all;
    for (const auto& warning : warnings()) all += warning;
    forget_warnings();
    return all;
  };
  // Half of what 4 m weigh is 37 kPa; of a dam of 30 m, 280 kPa.
  CHECK(of_mesh_file("5e4") == "");
  CHECK(of_mesh_file("1e4").find("/materials/s/shear_modulus: 10000 Pa is less than 4 m of this soil weigh") !=
        std::string::npos);
  CHECK(said_of_model("", "", "5e4") == "");
  CHECK(said_of_model("", "", "1e4").find("less than 4 m of this soil weigh") != std::string::npos);
}

TEST_CASE("histories with rows after the end only, void ratios and saturation in per cent") {
  CHECK(said_of_model(R"("output": { "history_interval": 1 },)") == "");
  CHECK(said_of_model(R"("output": { "history_interval": 20 },)")
            .find("/output/history_interval: 20 s is longer than the shaking (/shake/duration, 1 s)") !=
        std::string::npos);
  CHECK(said_of_model(R"("phreatic_line": [[-9, 2], [9, 2]], "above_phreatic_line": { "water": "soft_fluid",
                         "saturation": 90 },)")
            .find("/above_phreatic_line/saturation: found 90, but allowed is a fraction of at most 1; 90 % are 0.9") !=
        std::string::npos);
  CHECK(said_of_model("", "", R"(1e7, "porosity": 40)").find("/materials/s/porosity: found 40") != std::string::npos);
}

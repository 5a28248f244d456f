// What a case asks for: nodes that should hang together, places to look at, snapshots, and amounts that no machine has.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/model/mesh_joints.hpp"
#include "fem_stage/model/model.hpp"
#include "fem_stage/output/snapshot_plan.hpp"
#include "fem_stage/stage/shake.hpp"
#include "small_case.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

// Two blocks of 2 x 4 quadrilaterals side by side, the right one moved by (dx, dy). Lines: bottom, left, right, top,
// seam.
Mesh blocks(double dx, double dy) {
  Mesh mesh;
  mesh.region_names = {"s"};
  for (int block = 0; block < 2; ++block) {
    const auto first = static_cast<std::int64_t>(mesh.nodes());
    const auto node = [&](int i, int j) { return first + i + 3 * j; };
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 3; ++i)
        mesh.position.insert(mesh.position.end(), {i + 2.0 * block + block * dx, j + block * dy});
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 2; ++i) {
        for (const auto n : {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)}) mesh.quads.push_back(n);
        mesh.region.push_back(0);
      }
      mesh.lines[block == 0 ? "left" : "right"].push_back({node(2 * block, j), node(2 * block, j + 1)});
      mesh.lines[block == 0 ? "seam_left" : "seam_right"].push_back(
          {node(2 - 2 * block, j), node(2 - 2 * block, j + 1)});
    }
  }
  return mesh;
}

std::string case_refusal(const std::string& shake, const std::string& more = "") {
  return refusal([&] {
    const FemCase options = read_fem_case(case_file(shake, more), "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "tailrun_requests.msh");
    build_model(options, folder / "tailrun_requests.msh");
  });
}

}  // namespace

TEST_CASE("blocks that only look joined are refused; free-field columns may stand flush") {
  for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, std::pair{1e-9, 0.0}, std::pair{0.005, 0.002}}) {
    const Mesh mesh = blocks(dx, dy);
    CHECK(refusal([&] { check_joints(mesh, {}, "m.msh"); }).find("the mesh is cut: 5 pairs") != std::string::npos);
    BoundaryOptions beside;
    beside.free_field.push_back({"seam_left", "seam_right", 0.0, 0.0, 0.0, ""});
    CHECK(refusal([&] { check_joints(mesh, beside, "m.msh"); }).empty());
  }
  CHECK(refusal([&] { check_joints(blocks(0.5, 0.0), {}, "m.msh"); }).empty());
}

TEST_CASE("nodes without a partner are listed, not left loose") {
  for (const double off : {0.0, 0.0005, 0.002, 0.01, 0.3}) {
    const Mesh mesh = blocks(1.0, off);
    std::vector<std::int64_t> nodes = mesh.nodes_of_line("left");
    for (const auto node : mesh.nodes_of_line("right")) nodes.push_back(node);
    Freedoms freedoms(mesh.nodes());
    constexpr Freedom both[] = {freedom_ux, freedom_uy};
    const std::string message = refusal([&] { tie_equal_heights(freedoms, mesh, nodes, 1e-3, both, "/here"); });
    if (off <= 1e-3)
      CHECK(message.empty());
    else
      CHECK_MESSAGE(message.find("/here: 10 of 10 nodes have no partner") == 0, message);
  }
}

TEST_CASE("histories far from the mesh are refused with the nearest node") {
  CHECK(case_refusal(R"("duration": 1)",
                     R"("output": { "points": { "a": [2, 4], "b": [1.5, 2.5], "c": [-0.9, 0] } },)") == "");
  for (const char* key : {"points", "elements"}) {
    const std::string message =
        case_refusal(R"("duration": 1)", fmt::format(R"("output": {{ "{}": {{ "far": [1004, 4] }} }},)", key));
    CHECK_MESSAGE(message.find(fmt::format("/output/{}/far", key)) != std::string::npos, message);
    CHECK(message.find("1000 m off the mesh") != std::string::npos);
    CHECK(message.find("(4, 4)") != std::string::npos);
  }
}

TEST_CASE("snapshots: a name each, and a word for those that will not be as asked") {
  forget_warnings();
  const SnapshotPlan usual({8.0, 0.005}, {2.0, 2.5, 8.0}, 1.0);
  CHECK(usual.name(2.5) == "snapshot_t02.500.h5");
  CHECK(usual.count() == 9);
  CHECK(warnings().empty());
  const SnapshotPlan close({0.01, 0.0004}, {0.002, 0.0024, 0.0028, 0.5}, 0.0);
  CHECK(close.count() == 3);
  CHECK(close.name(0.002) == "snapshot_t00.0020.h5");
  CHECK(close.name(0.0024) == "snapshot_t00.0024.h5");
  REQUIRE(warnings().size() == 1);
  CHECK(warnings()[0].find("0.5 s: after the end") != std::string::npos);
  const SnapshotPlan coarse({1.0, 0.1}, {0.5, 0.52, 0.55}, 0.0);
  CHECK(coarse.count() == 2);
  CHECK(warnings().size() == 3);  // between steps; two on one step
  CHECK(SnapshotPlan(std::vector<double>{1.00001, 1.00002}).name(1.00002) == "snapshot_t01.00002.h5");
  forget_warnings();
}

TEST_CASE("amounts beyond any machine are refused with the numbers, before the computation") {
  CHECK(case_refusal(R"("duration": 8)") == "");
  CHECK(case_refusal(R"("duration": 8, "time_step": 1e-300)").find("8e+300 steps") != std::string::npos);
  CHECK(case_refusal(R"("duration": 1e9)").find("/shake/time_step") != std::string::npos);
  CHECK(case_refusal(R"("duration": 8)", R"("geostatic": { "settle_time": 2, "settle_step": 1e-12 },)")
            .find("/geostatic/settle_step") != std::string::npos);
  CHECK(case_refusal(R"("duration": 8)", R"("consolidation": { "largest_step": 1e-9 },)").find("largest_step") !=
        std::string::npos);
  CHECK(
      case_refusal(R"("duration": 8)", R"("consolidation": { "first_step": 1e-9, "growth": 1 },)").find("first_step") !=
      std::string::npos);
  std::ofstream(folder / "tailrun_requests.csv") << "0,0\n0.01,1\n0.02,0\n";
  CHECK(case_refusal(R"("duration": 8, "motion": "tailrun_requests.csv")") == "");
  CHECK(case_refusal(R"("duration": 8, "motion": "tailrun_requests.csv", "peak_acceleration": 0)") != "");
  FemCase options = read_fem_case(case_file(R"("duration": 8, "time_step": 1e-6)"), "");
  CHECK_NOTHROW(check_shake_output(options, 1e6, folder));
  options.output.snapshot_interval = 1e-6;
  CHECK(refusal([&] { check_shake_output(options, 1e8, folder); }).find("8e+06 snapshots") != std::string::npos);
}

TEST_CASE("rectangles beyond memory") {
  std::ofstream(folder / "tailrun_requests.json") << R"({ "mesh": { "rectangle": { "width": 4, "height": 4,
      "columns": 100000, "rows": 100000, "region": "s" } } })";
  CHECK(refusal([] { read_fem_case(folder / "tailrun_requests.json", ""); }).find("1e+10 elements") !=
        std::string::npos);
}

TEST_CASE("a line that stands under water twice is refused") {
  for (const char* ponds : {R"({ "lines": ["top", "top"], "level": 5 })",
                            R"({ "lines": ["top"], "level": 5 }, { "lines": ["top"], "level": 6 })"}) {
    const auto path = case_file(R"("duration": 1)", R"("phreatic_line": [[-9, 5], [9, 5]],)");
    std::ifstream file(path);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    file.close();
    const std::string before = R"("roller_lines")";
    text.insert(text.find(before), fmt::format(R"("ponded_water": [{}], )", ponds));
    std::ofstream(path) << text;
    CHECK(refusal([&] { read_fem_case(path, ""); }).find("'top' is under water twice") != std::string::npos);
  }
}

TEST_CASE("a phreatic line above the ground is warned of, with the depth, unless a pond stands there") {
  const auto told = [](double level, bool pond) {
    forget_warnings();
    const auto path = case_file(
        R"("duration": 1)",
        fmt::format(R"("geostatic": {{ "seepage": "hydrostatic" }}, "phreatic_line": [[-9, {0}], [9, {0}]],)", level));
    std::ifstream file(path);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    file.close();
    const std::string before = R"("roller_lines")";
    if (pond)
      text.insert(text.find(before), fmt::format(R"("ponded_water": [{{ "lines": ["top"], "level": {} }}], )", level));
    std::ofstream(path) << text;
    const FemCase options = read_fem_case(path, "");
    write_rectangle_mesh(*options.mesh.rectangle, folder / "tailrun_requests.msh");
    build_model(options, folder / "tailrun_requests.msh");
    std::string all;
    for (const auto& warning : warnings()) all += warning + "\n";
    return all.find("/phreatic_line: lies above the ground") == std::string::npos ? std::string() : all;
  };
  CHECK(told(9.0, false).find("at 5 of its 5 nodes, by up to 5 m") != std::string::npos);
  CHECK(told(9.0, true) == "");
  CHECK(told(4.05, false) == "");
  CHECK(told(2.0, false) == "");
}

TEST_CASE("rows and snapshots that are asked for far more often than there are steps are warned of, defaults are not") {
  const auto warned = [](const std::string& shake, const std::string& output) {
    forget_warnings();
    read_fem_case(case_file(shake, fmt::format(R"("output": {{ {} }},)", output)), "");
    std::string all;
    for (const auto& text : warnings()) all += text;
    return all;
  };
  const std::string coarse = R"("duration": 2, "time_step": 0.5)", fine = R"("duration": 2, "time_step": 0.005)";
  CHECK(warned(coarse, R"("history_interval": 1e-9)")
            .find("/output/history_interval: 1e-09 s is far below the time step "
                  "of 0.5 s; there is a row at every step") != std::string::npos);
  CHECK(warned(coarse, R"("snapshot_interval": 0.01)").find("a snapshot at every step") != std::string::npos);
  CHECK(warned(coarse, "").find("far below") == std::string::npos);
  CHECK(warned(fine, R"("history_interval": 0.005, "snapshot_interval": 0.5)").find("far below") == std::string::npos);
}

TEST_CASE("a pond and a phreatic line that do not meet are refused from 1 m, warned of from 0.1 m") {
  const auto said = [](double level, double line) {
    forget_warnings();
    const auto path = case_file(
        R"("duration": 1)",
        fmt::format(R"("geostatic": {{ "seepage": "hydrostatic" }}, "phreatic_line": [[-9, {0}], [9, {0}]],)", line));
    std::ifstream file(path);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    file.close();
    text.insert(text.find(R"("roller_lines")"),
                fmt::format(R"("ponded_water": [{{ "lines": ["top"], "level": {} }}], )", level));
    std::ofstream(path) << text;
    const std::string refused = refusal([&] {
      const FemCase options = read_fem_case(path, "");
      write_rectangle_mesh(*options.mesh.rectangle, folder / "tailrun_requests.msh");
      build_model(options, folder / "tailrun_requests.msh");
    });
    std::string all;
    for (const auto& warning : warnings()) all += warning;
    forget_warnings();
    return refused.empty() ? all : "error: " + refused;
  };
  CHECK(said(9.0, 9.0) == "");
  CHECK(said(9.0, 9.05) == "");
  CHECK(said(9.0, 8.5).find("the phreatic line lies at 8.5 m at x = 0 m, 0.5 m below it") != std::string::npos);
  CHECK_FALSE(said(9.0, 8.5).starts_with("error"));
  CHECK(said(9.0, 6.0).starts_with("error: /boundaries/ponded_water/0/level: the pond stands at 9 m"));
  CHECK(said(6.0, 9.0).find("3 m above it (off at 5 of the 5 nodes under its water)") != std::string::npos);
}

TEST_CASE("names in history.csv: none twice, none that breaks its header") {
  const auto output = [](const std::string& places) {
    return case_refusal(R"("duration": 1)", R"("output": { )" + places + " },");
  };
  CHECK(output(R"("points": { "top": [2, 4] }, "elements": { "middle": [1.5, 2.5] })") == "");
  CHECK(output(R"("points": { "a": [2, 4] }, "elements": { "a": [1.5, 2.5] })")
            .find("/output/elements: 'a' is the name of a point") != std::string::npos);
  for (const char* key : {"points", "elements"})
    CHECK(output(fmt::format(R"("{}": {{ "a,b": [2, 4] }})", key))
              .find(fmt::format("/output/{}: the name \"a,b\" has a comma", key)) != std::string::npos);
}

TEST_CASE("a physical curve whose name no snapshot can hold is refused") {
  Mesh mesh = blocks(0.5, 0.0);
  CHECK(refusal([&] { check_mesh(mesh, "m.msh"); }).find("slash") == std::string::npos);
  mesh.lines["up/down"] = mesh.lines["left"];
  CHECK(refusal([&] {
          check_mesh(mesh, "m.msh");
        }).find("m.msh: the name \"up/down\" of a physical curve has a slash") != std::string::npos);
}

TEST_CASE("loads that stay at nothing while the shaking lasts are warned of") {
  const auto warned = [](const std::string& history) {
    forget_warnings();
    read_fem_case(
        case_file(R"("duration": 2)",
                  R"("loads": [{ "line": "top", "pressure": 1e3, "stage": "shake", "history": )" + history + " }],"),
        "");
    std::string all;
    for (const auto& text : warnings()) all += text;
    forget_warnings();
    return all;
  };
  std::ofstream(folder / "tailrun_requests_late.csv") << "0,0\n3,0\n4,1\n";
  std::ofstream(folder / "tailrun_requests_soon.csv") << "0,0\n1.9,0\n4,1\n";
  for (const char* late :
       {R"({ "type": "ramp", "start": 5, "duration": 1 })", R"({ "type": "sine", "frequency": 1, "start": 2 })",
        R"({ "type": "ricker", "frequency": 2, "delay": 9 })",
        R"({ "type": "csv", "file": "tailrun_requests_late.csv" })"})
    CHECK_MESSAGE(warned(late).find("/loads/0/history: the load never acts") != std::string::npos, late);
  for (const char* acting :
       {R"({ "type": "ramp", "start": 1, "duration": 1 })", R"({ "type": "sine", "frequency": 1, "start": -1 })",
        R"({ "type": "ricker", "frequency": 2, "delay": 1 })",
        R"({ "type": "csv", "file": "tailrun_requests_soon.csv" })"})
    CHECK_MESSAGE(warned(acting) == "", acting);
}

TEST_CASE("the region of /output/liquefaction is looked for before anything is computed") {
  const auto region = [](const char* name, const char* window) {
    return case_refusal(
        R"("duration": 1)",
        fmt::format(R"("output": {{ "liquefaction": {{ "region": "{}", "window": {} }} }},)", name, window));
  };
  CHECK(region("s", "[0, 4]") == "");
  CHECK(region("S1", "[0, 4]").find("/output/liquefaction/region: the mesh has no region 'S1'. Did you mean 's'?") !=
        std::string::npos);
  CHECK(region("s", "[10, 14]").find("they lie from x = 0.5 to 3.5 m") != std::string::npos);
  CHECK(region("s", "[4, 0]").find("/output/liquefaction/window") != std::string::npos);
}

TEST_CASE("a line that the mesh lacks is refused at the key that names it") {
  const auto with = [](const std::string& before, const std::string& after) {
    const auto path = case_file(R"("duration": 1)");
    std::ifstream file(path);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    file.close();
    text.replace(text.find(before), before.size(), after);
    std::ofstream(path) << text;
    return refusal([&] {
      const FemCase options = read_fem_case(path, "");
      write_rectangle_mesh(*options.mesh.rectangle, folder / "tailrun_requests.msh");
      build_model(options, folder / "tailrun_requests.msh");
    });
  };
  const std::string rollers = R"("roller_lines": ["left", "right"])", base = R"("line": "bottom")";
  CHECK(with(rollers, R"("roller_lines": ["lft"])").starts_with("/boundaries/roller_lines: the mesh has no"));
  CHECK(with(rollers, R"("geostatic_roller_lines": ["lft"])").starts_with("/boundaries/geostatic_roller_lines: "));
  CHECK(with(rollers, rollers + R"(, "periodic_lines": ["lft"])").starts_with("/boundaries/periodic_lines: "));
  CHECK(with(base, R"("line": "botom")")
            .find("/boundaries/base/line: the mesh has no physical curve 'botom'. Did you mean "
                  "'bottom'?") != std::string::npos);
}

TEST_CASE("snapshots after the end of the consolidation are warned of") {
  const auto warned = [](const char* times) {
    forget_warnings();
    read_fem_case(case_file(R"("duration": 2)",
                            fmt::format(R"("consolidation": {{ "duration": 100, "snapshots": {} }},)", times)),
                  "");
    const auto count = warnings().size();
    forget_warnings();
    return count;
  };
  CHECK(warned("[50, 100]") == 0);
  CHECK(warned("[50, 500]") == 1);
}

// Geometries from elsewhere: no programs, no end of ours, no waiting for ever, and none of the user's own gmsh
// settings.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/error.hpp"
#include "fem_stage/mesh/geo_commands.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"
#include "fem_stage/mesh/isolated.hpp"

using namespace tailrun;
using namespace tailrun::fem;
namespace fs = std::filesystem;

namespace {

const char* const square = R"(
  Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
  Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
  Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
  Transfinite Curve {1, 2, 3, 4} = 3; Transfinite Surface {1}; Recombine Surface {1};
  Physical Surface("soil") = {1}; Physical Curve("outline") = {1, 2, 3, 4};
)";

struct Folder {
  fs::path path = fs::temp_directory_path() / "tailrun_foreign_geometry";
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  fs::path written(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return path / name;
  }
};

std::string refusal(const Folder& folder, const std::string& geometry, GeometryOptions options = {}) {
  try {
    mesh_geometry(folder.written("g.geo", geometry), options, folder.path / "g.msh");
  } catch (const InputError& error) {
    CHECK(!fs::exists(folder.path / "g.msh"));
    return error.what();
  }
  return "";
}

std::string bytes(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("commands that start programs or write files are refused, wherever they hide") {
  const Folder folder;
  const std::string mark = (folder.path / "was_here").string();
  for (const std::string& command : std::vector<std::string>{
           "SystemCall \"touch " + mark + "\";", "NonBlockingSystemCall \"touch " + mark + "\";",
           "System \"touch " + mark + "\";", "OnelabRun(\"x\", \"touch " + mark + "\");",
           "Field[1] = ExternalProcess; Field[1].CommandLine = \"touch " + mark + "\"; Background Field = 1;",
           "Save \"" + mark + "\";", "Print \"" + mark + "\";", "Printf(\"a\") > \"" + mark + "\";",
           "Printf(\"%g\", 1) >> \"" + mark + "\";", "CreateDir \"" + mark + "\";",
           "Parse(StrCat(\"System\", \"Call 'touch " + mark + "';\"));", "name = \"inner.geo\"; Include name;",
           "Include \"inner.geo\";", "Merge \"inner.geo\";",
           "x = \"a\\\" b\"; SystemCall \"touch " + mark + "\"; y = \"c\";",
           "x = \"a\n\"; Printf(\"a\") > \"" + mark + "\";", "x = \"a\n\"; SystemCall \"touch " + mark + "\";",
           "If (1) SystemCall(\"touch " + mark + "\"); EndIf", "/* */ SystemCall /* */ Str(\"touch " + mark + "\");"}) {
    folder.written("inner.geo", "NonBlockingSystemCall \"touch " + mark + "\";\n");
    const std::string message = refusal(folder, square + command);
    CHECK_MESSAGE(message.find("--trust-geometry") != std::string::npos, command, message);
    CHECK_MESSAGE(!fs::exists(mark), command);
  }
  CHECK(refusal(folder, std::string("// SystemCall\n/* Save \"x\"; */\nPrintf(\"Save the dam\");\n"
                                    "Print.Background = 1;\n") +
                            square) == "");
}

TEST_CASE("a trusted geometry may start programs; the second lock holds the others") {
  const Folder folder;
  const std::string mark = (folder.path / "was_here").string();
  const auto geometry = folder.written("t.geo", square + ("SystemCall \"touch " + mark + "\";"));
  mesh_geometry(geometry, {{}, 60.0, true}, folder.path / "t.msh");
  CHECK(fs::exists(mark));
}

TEST_CASE("work in a process of its own: no programs, its own end, its exceptions and its result") {
  const Folder folder;
  const std::string mark = (folder.path / "was_here").string(), touch = "touch " + mark;
  const auto start_program = [&] { return std::to_string(std::system(touch.c_str())); };
  CHECK(run_isolated("x", {}, start_program) != "0");
  CHECK(!fs::exists(mark));
  IsolationLimits trusted;
  trusted.may_start_programs = true;
  CHECK(run_isolated("x", trusted, start_program) == "0");
  CHECK(fs::exists(mark));
  const std::string large(5'000'000, 'a');
  CHECK(run_isolated("x", {}, [&] { return large; }) == large);
  CHECK_THROWS_WITH_AS(run_isolated("x", {}, []() -> std::string { throw InputError("mine"); }), "mine", InputError);
  CHECK_THROWS_AS(run_isolated("x", {}, []() -> std::string { throw ComputationError("y"); }), ComputationError);
  CHECK_THROWS_AS(run_isolated("x", {}, []() -> std::string { std::exit(0); }), InputError);
  CHECK_THROWS_AS(run_isolated("x", {}, []() -> std::string { std::abort(); }), InputError);
#ifndef __SANITIZE_ADDRESS__
  IsolationLimits small;
  small.memory = std::size_t{1} << 28;
  CHECK_THROWS_AS(run_isolated("x", small, [] { return std::string(std::size_t{1} << 30, 'a'); }), InputError);
#endif
}

TEST_CASE("Exit ends gmsh, not the program; loops and macros without end are stopped") {
  const Folder folder;
  CHECK(refusal(folder, std::string("Exit;\n") + square).find("ended gmsh") != std::string::npos);
  CHECK(refusal(folder, std::string(square) + "If (1)\n Exit;\nEndIf\n").find("ended gmsh") != std::string::npos);
  const auto start = std::chrono::steady_clock::now();
  for (const char* endless :
       {"Macro Again\n a = 1;\n Call Again;\nReturn\nCall Again;\n", "For i In {1:2000000000}\n a = 1;\nEndFor\n"})
    CHECK(refusal(folder, endless, {{}, 0.5, false}).find("/mesh/time_limit") != std::string::npos);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
}

TEST_CASE("the user's own gmsh settings do not change the dam") {
  const Folder folder;
  const auto geometry = folder.written("g.geo", square);
  mesh_geometry(geometry, {}, folder.path / "without.msh");
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  folder.written(".gmshrc", "Mesh.ScalingFactor = 2;\nMesh.SaveAll = 1;\nMesh.ElementOrder = 2;\n");
  setenv("HOME", folder.path.c_str(), 1);
  for (const bool trusted : {false, true}) {
    const Mesh mesh = mesh_geometry(geometry, {{}, 60.0, trusted}, folder.path / "with.msh");
    CHECK(bytes(folder.path / "with.msh") == bytes(folder.path / "without.msh"));
    CHECK(*std::max_element(mesh.position.begin(), mesh.position.end()) == 1.0);
  }
  setenv("HOME", before.c_str(), 1);
}

TEST_CASE("the mesh that is reported is the one on disk: a scale in the geometry itself counts") {
  const Folder folder;
  const Mesh mesh = mesh_geometry(folder.written("s.geo", std::string("Mesh.ScalingFactor = 2;\n") + square), {},
                                  folder.path / "s.msh");
  CHECK(mesh.position == read_gmsh(folder.path / "s.msh").position);
  CHECK(*std::max_element(mesh.position.begin(), mesh.position.end()) == 2.0);
}

TEST_CASE("reversed entities keep the name of their group") {
  const Folder folder;
  std::string geometry = square;
  geometry.replace(geometry.find("(\"soil\") = {1}"), 14, "(\"soil\") = {-1}");
  geometry.replace(geometry.find("(\"outline\") = {1, 2, 3, 4}"), 26, "(\"outline\") = {-1, -2, 3, 4}");
  const Mesh mesh = mesh_geometry(folder.written("r.geo", geometry), {}, folder.path / "r.msh");
  CHECK(mesh.region_names == std::vector<std::string>{"soil"});
  CHECK(mesh.lines.at("outline").size() == 8);
}

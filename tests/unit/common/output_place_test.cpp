#include "common/output_place.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/case_file.hpp"
#include "common/error.hpp"

namespace fs = std::filesystem;

TEST_CASE("no result takes the place of what a case names, nor of the case itself") {
  const fs::path folder = fs::temp_directory_path() / ("tailrun_places_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "summary.json") << R"({"table": "history.csv"})";
  std::ofstream(folder / "history.csv") << "time,factor\n";
  const tailrun::CaseFile file(folder / "summary.json");
  CHECK(file.inputs() == std::vector<fs::path>{folder / "summary.json"});
  file.root().file("table");
  CHECK(file.inputs().size() == 2);
  CHECK_THROWS_AS(tailrun::require_results_apart(folder, {"history.csv"}, file.inputs()), tailrun::InputError);
  CHECK_THROWS_AS(tailrun::require_results_apart(folder / ".", {"summary.json"}, file.inputs()), tailrun::InputError);
  CHECK_NOTHROW(tailrun::require_results_apart(folder, {"quality.csv"}, file.inputs()));
  CHECK_NOTHROW(tailrun::require_results_apart(folder / "out", {"history.csv", "summary.json"}, file.inputs()));
  fs::remove_all(folder);
}

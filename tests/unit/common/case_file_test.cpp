#include "common/case_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "common/error.hpp"

using namespace tailrun;

namespace {

CaseFile written(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_case_test.json";
  std::ofstream(path) << text;
  return CaseFile(path);
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("values, defaults and the echo") {
  const CaseFile file = written(R"({"newmark": {"gamma": 0.7} /* comment */, "names": ["a", "b"]})");
  const CaseNode newmark = file.root().object("newmark");
  CHECK(newmark.number("gamma", "1", Range::between(0.5, 1)) == 0.7);
  CHECK(newmark.number_or("beta", "1", Range::positive(), 0.25) == 0.25);
  CHECK(file.root().texts_or("names", {}).size() == 2);
  CHECK_NOTHROW(file.finish());
  CHECK(file.echo()[1] == "newmark/beta = 0.25  (default)");
}

TEST_CASE("an unknown key names its pointer and the nearest known one") {
  const CaseFile file = written(R"({"shake": {"time_stpe": 0.01}})");
  file.root().object("shake").number_or("time_step", "s", Range::positive(), 0.005);
  const std::string text = message([&] { file.finish(); });
  CHECK(contains(text, "/shake/time_stpe"));
  CHECK(contains(text, "Did you mean 'time_step'?"));
}

TEST_CASE("wrong type, range, missing key and broken JSON are told apart") {
  const CaseFile file = written(R"({"a": "x", "b": -1, "gravty": 9.81})");
  const CaseNode root = file.root();
  CHECK(contains(message([&] { root.number("a", "m", Range::any()); }), "/a: found string \"x\""));
  CHECK(contains(message([&] { root.number("b", "Pa", Range::positive()); }), "allowed is (0, inf) [Pa]"));
  CHECK(contains(message([&] { root.number("gravity", "m/s2", Range::any()); }), "found 'gravty' instead"));
  CHECK(contains(message([] { written("{\"a\": 1,}"); }), "not valid JSON"));
  CHECK(contains(message([] { CaseFile("/nonexistent/fem.json"); }), "no such case file"));
}

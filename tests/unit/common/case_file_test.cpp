#include "common/case_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "common/application.hpp"
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

TEST_CASE("of the options those are told that differ from their defaults; the file beside the results has all") {
  const CaseFile file =
      written(R"({"dt": 0.01, "gamma": 0.5, "kind": "fixed", "title": "a, default: b", "points": [1, 2], "on": true})");
  const CaseNode root = file.root();
  root.number("dt", "s", Range::positive());                 // required: has no default
  root.number_or("gamma", "1", Range::positive(), 0.5);      // given, and the default
  root.number_or("beta", "1", Range::positive(), 0.25);      // not given
  root.choice_or("kind", {"open", "fixed"}, "open");         // given, another
  root.text_or("title", "");                                 // given, a text that has no default
  root.numbers_or("points", "m", Range::any(), {1.0, 2.0});  // given, and the default
  root.boolean_or("on", false);                              // given, another
  const auto told = differing_options(file.echo());
  REQUIRE(told.size() == 2);
  CHECK(told[0] == "kind = fixed  (default: open)");
  CHECK(told[1] == "on = true  (default: false)");

  const auto place = std::filesystem::temp_directory_path() / "tailrun_case_test.options.txt";
  write_options(place, "program run case.json", file.echo());
  std::ifstream stream(place);
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(stream, line)) lines.push_back(line);
  REQUIRE(lines.size() == 8);
  CHECK(lines[0] == "program run case.json");
  for (std::size_t k = 0; k < 7; ++k) CHECK(lines[k + 1] == "  " + file.echo()[k]);
  std::filesystem::remove(place);
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

namespace {

std::string refusal(const std::string& text) {
  return message([&] { written(text); });
}

}  // namespace

TEST_CASE("a key that is there twice is refused with its pointer, at any depth and in lists") {
  CHECK(contains(refusal(R"({"a": 1, "a": 2})"), "/a: this key is there twice"));
  CHECK(contains(refusal(R"({"m": {"clay": {"phi": 1, "phi": 1}}})"), "/m/clay/phi: this key is there twice"));
  CHECK(contains(refusal(R"({"rules": [{"x": 1}, {"y": 1, "z": [0], "y": 2}]})"), "/rules/1/y: this key"));
  CHECK(refusal(R"({"a": {"x": 1}, "b": {"x": 1}, "c": [{"x": 1}, {"x": 1}]})").empty());
}

TEST_CASE("numbers beyond double, deep nesting and integers beyond long") {
  CHECK(contains(refusal(R"({"shake": {"duration": 1e400}})"), "/shake/duration: a number beyond the range of double"));
  CHECK(contains(refusal(R"({"a": [0, -1e999]})"), "/a/1: a number beyond"));
  const auto nested = [](std::size_t levels) {
    return "{\"a\": " + std::string(levels, '[') + std::string(levels, ']') + "}";
  };
  CHECK(refusal(nested(90)).empty());
  CHECK(contains(refusal(nested(100000)), "nested deeper than 100 levels"));
  CHECK(contains(refusal(std::string(100000, '[') + std::string(100000, ']')), "nested deeper than 100 levels"));
  const CaseFile file = written(R"({"n": 18446744073709551615, "m": -3})");
  CHECK(contains(message([&] { file.root().integer("n", 0, 10); }), "an integer in [0, 10] is required"));
}

TEST_CASE("what is not JSON is said in words, with line and column") {
  CHECK(contains(refusal("{\n  \"a\": 1,\n}"), "line 3, column 1: a comma before the closing bracket"));
  CHECK(contains(refusal("{\"a\": 1 \"b\": 2}"), "line 1, column 11: a comma or a closing bracket is missing"));
  CHECK(contains(refusal("{\"a\": 0,5}"), "where a key in double quotes is required"));
  CHECK(contains(refusal("{'a': 1}"), "double quotes"));
  CHECK(contains(refusal("{\"a\": NaN}"), "NaN and Infinity are not allowed"));
  CHECK(contains(refusal("{\"a\": 1"), "ends too early"));
  CHECK(contains(refusal("{\"a\": \"M\xfcnchen\"}"), "save the file as UTF-8"));
  CHECK(contains(refusal(""), "the file is empty"));
  CHECK(contains(refusal("[1, 2]"), "must be a JSON object"));
  for (const char* text : {"{\n  \"a\": 1,\n}", "{\"a\": .5}", "{\"a\": tru}", "{", "{\"a\": 1e999}", "{\"a\" 1}"})
    CHECK_FALSE(contains(refusal(text), "json.exception"));
  CHECK(contains(message([] { CaseFile{std::filesystem::temp_directory_path()}; }), "is a folder"));
}

TEST_CASE("a text in place of a number: what it says in the key's own unit") {
  const auto refusal = [](const std::string& value, const char* unit) {
    const CaseFile file = written("{\"cohesion\": \"" + value + "\"}");
    return message([&] { file.root().number("cohesion", unit, Range::positive()); });
  };
  CHECK(contains(refusal("8kPa", "Pa"), "found string \"8kPa\", but a number [Pa]"));
  CHECK(contains(refusal("8kPa", "Pa"), "write the number alone, in Pa: 8000"));
  CHECK(contains(refusal("8 MPa", "Pa"), "in Pa: 8e+06"));
  CHECK(contains(refusal("12 m", "m"), "in m: 12"));
  CHECK(contains(refusal("8 psf", "Pa"), "write the number alone, in Pa"));
  CHECK_FALSE(contains(refusal("8 psf", "Pa"), "in Pa: "));
  CHECK(contains(refusal("8000", "Pa"), "without quotes: 8000"));
  CHECK_FALSE(contains(refusal("soft", "Pa"), "write the number"));
}

TEST_CASE("a word in other letters is the nearest one") {
  const CaseFile file = written(R"({"transfer": "FLIP"})");
  CHECK(contains(message([&] { file.root().choice("transfer", {"aflip", "apic", "flip"}); }), "Did you mean 'flip'?"));
}

TEST_CASE("an HDF5 file in the place of a case file is called one") {
  CHECK(contains(message([] { written("\x89HDF\r\n\x1a\n"); }), "found an HDF5 file, but a case file (JSON)"));
}

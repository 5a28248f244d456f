#include "common/case_settings.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <fstream>

#include "common/case_file.hpp"
#include "common/error.hpp"

using namespace tailrun;
using doctest::Contains;

namespace {

const char* const case_text =
    R"({"newmark": {"gamma": 0.7} /* why */, "rules": [{"factor": 1}, {"factor": 2}], "title": "t"})";

nlohmann::ordered_json with(const std::vector<std::string>& texts) {
  std::vector<CaseSetting> settings;
  for (const auto& text : texts) settings.push_back(parse_setting(text));
  auto json = nlohmann::ordered_json::parse(case_text, nullptr, true, true);
  apply_settings(json, settings, "fem.json");
  return json;
}

// Opened with settings, which are taken back at once.
CaseFile opened(const std::vector<std::string>& texts) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_settings_test.json";
  std::ofstream(path) << case_text;
  use_settings(texts);
  try {
    CaseFile file(path);
    use_settings({});
    return file;
  } catch (...) {
    use_settings({});
    throw;
  }
}

}  // namespace

TEST_CASE("a setting's value is JSON, or else a text") {
  CHECK(parse_setting("/a=0.5").value == 0.5);
  CHECK(parse_setting("/a=true").value == true);
  CHECK(parse_setting("/a=[1, 2]").value.size() == 2);
  CHECK(parse_setting("/a=\"0.5\"").value == "0.5");
  CHECK(parse_setting("/a=pm4sand").value == "pm4sand");
  CHECK(parse_setting("/a=x=y").value == "x=y");
  CHECK(parse_setting("/a=0,5").value == "0,5");
  CHECK(parse_setting("/a=").value == "");
  CHECK_THROWS_WITH_AS(parse_setting("/a={\"b\": 1,}"), Contains("--set /a: not valid JSON"), InputError);
  CHECK_THROWS_WITH_AS(parse_setting("/a=1e999"), Contains("beyond the range of double"), InputError);
  CHECK_THROWS_WITH_AS(parse_setting("/a={\"b\": 1, \"b\": 2}"), Contains("this key is there twice"), InputError);
}

TEST_CASE("what is no setting is refused") {
  for (const char* text : {"", "=1", "a=1", "/a", "a/b=1"})
    CHECK_THROWS_WITH_AS(parse_setting(text), Contains("a setting is /pointer=value"), InputError);
  CHECK_THROWS_WITH_AS(parse_setting("/a=M\xfcnchen"), Contains("not UTF-8"), InputError);
  CHECK_THROWS_WITH_AS(use_settings({"/a=1", "/b=1", "/a=2"}), Contains("--set /a: given twice"), InputError);
  CHECK(settings_in_use().empty());
}

TEST_CASE("settings change keys and elements, and make the objects that the file lacks") {
  CHECK(with({"/newmark/gamma=0.6"})["newmark"]["gamma"] == 0.6);
  CHECK(with({"/newmark/beta=0.3"})["newmark"].dump() == R"({"gamma":0.7,"beta":0.3})");
  CHECK(with({"/rules/1/factor=5", "/rules/0={\"x\": 1}"})["rules"].dump() == R"([{"x":1},{"factor":5}])");
  CHECK(with({"/fluid={\"density\": 1}", "/fluid/density=2"})["fluid"]["density"] == 2);
  CHECK(with({"/a~1b~0=1"})["a/b~"] == 1);
  CHECK(with({"/fluid/density=1", "/fluid/deep/er=2"})["fluid"].dump() == R"({"density":1,"deep":{"er":2}})");
  CHECK(with({"/rules/1/when/region=a"})["rules"][1].dump() == R"({"factor":2,"when":{"region":"a"}})");
}

TEST_CASE(
    "an object that a setting made is checked like the file's: what no reader asks for is unknown, with the nearest "
    "word") {
  const auto read_rest = [](const CaseFile& file) {
    file.root().object("newmark").number("gamma", "1", Range::positive());
    file.root().text("title");
    for (const CaseNode& rule : file.root().list("rules")) rule.number("factor", "1", Range::positive());
  };
  const CaseFile file = opened({"/fluid/densty=1"});
  const CaseNode fluid = file.root().object("fluid");
  CHECK(fluid.number_or("density", "kg/m3", Range::positive(), 1000.0) == 1000.0);
  read_rest(file);
  CHECK_THROWS_WITH_AS(
      file.finish(), Contains("/fluid/densty (from --set): unknown key 'densty'. Did you mean 'density'?"), InputError);
  const CaseFile other = opened({"/fluidd/density=1"});
  CHECK_FALSE(other.root().object_if("fluid"));
  read_rest(other);
  CHECK_THROWS_WITH_AS(other.finish(), Contains("/fluidd (from --set): unknown key 'fluidd'. Did you mean 'fluid'?"),
                       InputError);
}

TEST_CASE("a way that leads nowhere names the nearest word there is") {
  CHECK_THROWS_WITH_AS(with({"/newmrk/gamma=1"}), Contains("there is no /newmrk. Did you mean 'newmark'?"), InputError);
  CHECK_THROWS_WITH_AS(with({"/newmrk/gamma=1"}), Contains("--set /newmrk/gamma=1: fem.json"), InputError);
  CHECK_THROWS_WITH_AS(with({"/newmrk/gamma=1"}), Contains("--set '/newmrk={\"gamma\":1}'"), InputError);
  for (const char* slip : {"/nwemark/gamma=1", "/newmarkk/gamma=1", "/ewmark/gamma=1", "/newmakr/gamma=1"})
    CHECK_THROWS_WITH_AS(with({slip}), Contains("Did you mean 'newmark'?"), InputError);
  CHECK(with({"/tailings/x=1"})["tailings"]["x"] == 1);
  CHECK(with({"/tides/x=1"})["tides"]["x"] == 1);  // three letters from title, and so a word of its own
  for (const char* text : {"/rules/2/factor=1", "/rules/-=1", "/rules/2=1", "/rules/01=1", "/rules/=1"})
    CHECK_THROWS_WITH_AS(with({text}), Contains("/rules is a list with elements 0 to 1"), InputError);
  CHECK_THROWS_WITH_AS(with({"/title/x=1"}), Contains("/title is a string"), InputError);
  CHECK_THROWS_WITH_AS(with({"/title/x=1"}), Contains("give it as a whole: --set '/title=...'"), InputError);
  CHECK_THROWS_WITH_AS(with({"/gravity/1=-9.81"}),
                       Contains("has no /gravity, and a setting changes elements of lists and makes none"), InputError);
}

TEST_CASE("a setting is checked like the file, and messages say where the value came from") {
  const CaseFile file = opened({"/newmark/gamma=-1", "/newmark/gama=1", "/title=3"});
  const CaseNode newmark = file.root().object("newmark");
  CHECK_THROWS_WITH_AS(newmark.number("gamma", "1", Range::positive()),
                       Contains("/newmark/gamma (from --set): found -1, but allowed is (0, inf)"), InputError);
  CHECK_THROWS_WITH_AS(file.root().text("title"), Contains("/title (from --set): found number 3"), InputError);
  CHECK(file.root().list("rules").size() == 2);
  CHECK_THROWS_WITH_AS(file.finish(), Contains("/newmark/gama (from --set): unknown key 'gama'. Did you mean 'gamma'?"),
                       InputError);
}

TEST_CASE("the echo marks what was set") {
  const CaseFile file = opened({"/newmark/gamma=0.6"});
  const CaseNode newmark = file.root().object("newmark");
  newmark.number("gamma", "1", Range::positive());
  newmark.number_or("beta", "1", Range::positive(), 0.25);
  file.root().text("title");
  CHECK(file.echo()[0] == "newmark/gamma = 0.6  (from --set)");
  CHECK(file.echo()[1] == "newmark/beta = 0.25  (default)");
  CHECK(file.echo()[2] == "title = t");
}

TEST_CASE("the text for the provenance is the file's own, or the case file that says the same as the settings") {
  CHECK(opened({}).text() == case_text);
  const std::string text = opened({"/newmark/gamma=0.6", "/title=two\nlines"}).text();
  CHECK(text.starts_with("// --set \"/newmark/gamma=0.6\"\n// --set \"/title=two\\nlines\"\n{\n"));
  const auto json = nlohmann::ordered_json::parse(text, nullptr, true, true);
  CHECK(json == with({"/newmark/gamma=0.6", "/title=two\nlines"}));
}

TEST_CASE("settings are quoted for a shell") {
  use_settings({"/a=it's", "/b=[1, 2]"});
  CHECK(settings_as_options() == R"( --set '/a=it'\''s' --set '/b=[1, 2]')");
  use_settings({});
}

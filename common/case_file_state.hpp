// What a case file and its nodes share (case_file.hpp); for case_file.cpp and case_node.cpp alone.
#pragma once

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "common/case_settings.hpp"
#include "common/json_text.hpp"

namespace tailrun {

using Json = nlohmann::ordered_json;

struct CaseFile::State {
  std::filesystem::path path;
  std::string text;
  Json json;
  std::vector<CaseSetting> settings;
  std::map<std::string, std::set<std::string>> known;  // by pointer of the object
  std::map<std::string, const Json*> visited;          // objects that somebody read
  std::vector<std::string> echo;
  std::vector<std::filesystem::path> inputs;

  // Behind a pointer in messages: that its value is not the file's own.
  std::string origin(const std::string& pointer) const { return is_set(pointer, settings) ? " (from --set)" : ""; }
};

// The pointer of a member.
inline std::string child(const std::string& pointer, const std::string& key) {
  return pointer + "/" + key;
}

// What a message calls a value.
inline std::string kind(const Json& value) {
  std::string shown = text_of_json(value);
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  return fmt::format("{} {}", value.type_name(), shown);
}

}  // namespace tailrun

// Values of the case file given on the command line, `--set /json/pointer=value`. They replace what the file says
// before anything is read, so that they are checked as if they stood in it. What a setting can do: give a key of an
// object, which is made where the file lacks it, or an element of a list that is there. A misspelt way to it is an
// InputError with the nearest word: here when the file has such a word, from the reader when only the reader knows it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tailrun {

struct CaseSetting {
  std::string text;               // as given: "/residual_strength/factor=0.5"
  std::string pointer;            // for messages: "/residual_strength/factor"
  std::vector<std::string> keys;  // "residual_strength", "factor"
  nlohmann::ordered_json value;   // JSON, or else the text itself
};

// Throws InputError: no '=', no pointer, not UTF-8, or a value that begins as JSON and goes wrong.
CaseSetting parse_setting(const std::string& text);

// Throws InputError naming the setting and `path`: an object on the way is misspelt, an index is beyond its list.
void apply_settings(nlohmann::ordered_json& json, const std::vector<CaseSetting>& settings,
                    const std::filesystem::path& path);

// The case file that would have said the same: the settings as a comment, then `json`.
std::string effective_text(const nlohmann::ordered_json& json, const std::vector<CaseSetting>& settings);

// True when `pointer` is what some setting gave, lies within it, or holds it.
bool is_set(const std::string& pointer, const std::vector<CaseSetting>& settings);

// What this process was given: every case file that is opened from now on is read with it. An empty list takes it back.
// Throws InputError as parse_setting does, and when a pointer is given twice.
void use_settings(const std::vector<std::string>& texts);
const std::vector<CaseSetting>& settings_in_use();

// As they were given, for summaries.
std::vector<std::string> texts_of_settings();
// " --set '/a/b=0.5'" for each, for a shell.
std::string settings_as_options();

}  // namespace tailrun

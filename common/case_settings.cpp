#include "common/case_settings.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

#include "common/error.hpp"
#include "common/json_text.hpp"

namespace tailrun {
namespace {

using Json = nlohmann::ordered_json;

std::vector<CaseSetting>& kept() {
  static std::vector<CaseSetting> list;
  return list;
}

// The words between the slashes; ~1 stands for a slash and ~0 for a tilde (RFC 6901).
std::vector<std::string> words_of(const std::string& pointer) {
  std::vector<std::string> words;
  for (std::size_t start = 1; start <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', start), pointer.size());
    std::string word;
    for (std::size_t k = start; k < end; ++k) {
      const bool escaped = pointer[k] == '~' && k + 1 < end && (pointer[k + 1] == '0' || pointer[k + 1] == '1');
      word += !escaped ? pointer[k] : pointer[k + 1] == '1' ? '/' : '~';
      k += escaped;
    }
    words.push_back(word);
    start = end + 1;
  }
  return words;
}

[[noreturn]] void refuse(const CaseSetting& setting, const std::filesystem::path& path, const std::string& message) {
  throw InputError(fmt::format("--set {}: {}: {}", setting.text, path.string(), message));
}

// Which element of `list` is meant.
std::size_t index_of(const std::string& word, const Json& list, const std::string& place, const CaseSetting& setting,
                     const std::filesystem::path& path) {
  std::size_t index = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, index);
  const bool is_index = error == std::errc() && stop == end && (word == "0" || word.front() != '0');
  if (is_index && index < list.size()) return index;
  refuse(setting, path,
         fmt::format("found '{}', but {} is a list {}; a setting changes elements and adds none", word, place,
                     list.empty() ? "without elements"
                                  : fmt::format("with elements 0 to {}, counted from 0", list.size() - 1)));
}

// Whether the words differ in two neighbouring letters at most: a slip, and not another word.
bool nearly(const std::string& a, const std::string& b) {
  const std::size_t most = std::max(a.size(), b.size()), least = std::min(a.size(), b.size());
  std::size_t before = 0, behind = 0;
  while (before < least && a[before] == b[before]) ++before;
  while (behind < least - before && a[a.size() - 1 - behind] == b[b.size() - 1 - behind]) ++behind;
  return most - before - behind <= 2;
}

// An object on the way that the file lacks is made, for the reader to judge. One that is spelt nearly like a key that
// is there would be judged by what is missing in it, and is refused here.
Json& member_of(Json& object, std::size_t depth, const std::string& place, const CaseSetting& setting,
                const std::filesystem::path& path) {
  const std::string& key = setting.keys[depth];
  if (const auto it = object.find(key); it != object.end()) return *it;
  if (depth + 1 == setting.keys.size()) return object[key];  // the reader says whether there is such a key
  std::vector<std::string> there;
  for (const auto& [name, unused] : object.items()) there.push_back(name);
  const auto slip = std::find_if(there.begin(), there.end(), [&](const auto& name) { return nearly(key, name); });
  if (slip != there.end()) {
    Json whole = setting.value;
    for (std::size_t k = setting.keys.size() - 1; k > depth; --k) whole = Json{{setting.keys[k], whole}};
    refuse(setting, path,
           fmt::format("there is no {}/{}. Did you mean '{}'? There is: {}. If it is meant, give it as a whole: "
                       "--set '{}/{}={}'",
                       place, key, *slip, joined(there), place, key, text_of_json(whole)));
  }
  // An index into what the file lacks: no list is made for one element of it.
  if (const std::string& next = setting.keys[depth + 1];
      !next.empty() && next.find_first_not_of("0123456789") == std::string::npos)
    refuse(setting, path,
           fmt::format("the file has no {0}/{1}, and a setting changes elements of lists and makes none; give the list "
                       "as a whole: --set '{0}/{1}=[...]'",
                       place, key));
  return object[key] = Json::object();
}

}  // namespace

CaseSetting parse_setting(const std::string& text) {
  const auto fail = [&](const std::string& message) { throw InputError(fmt::format("--set {}: {}", text, message)); };
  if (!is_utf8(text)) throw InputError("--set: a character that is not UTF-8");
  const std::size_t equals = text.find('=');
  if (text.empty() || text.front() != '/' || equals == std::string::npos)
    fail("a setting is /pointer=value, for instance /time/end=20 or /materials/tailings/friction_angle=30");
  CaseSetting setting;
  setting.text = text;
  setting.keys = words_of(text.substr(0, equals));
  for (const auto& key : setting.keys) setting.pointer += "/" + key;
  const std::string value = text.substr(equals + 1);
  const std::size_t first = value.find_first_not_of(" \t\r\n");
  const bool begins_as_json = first != std::string::npos && std::string("{[\"").find(value[first]) != std::string::npos;
  // What is a number by its looks but beyond double is refused rather than taken as a text.
  const bool looks_as_number = !value.empty() && value.find_first_not_of("0123456789+-.eE") == std::string::npos &&
                               value.find_first_of("0123456789") == 0;
  if (Json::accept(value, true) || begins_as_json || looks_as_number)
    setting.value = parse_json("--set " + setting.pointer, value);
  else
    setting.value = value;
  return setting;
}

void apply_settings(Json& json, const std::vector<CaseSetting>& settings, const std::filesystem::path& path) {
  for (const CaseSetting& setting : settings) {
    Json* value = &json;
    std::string place;
    for (std::size_t depth = 0; depth < setting.keys.size(); ++depth) {
      const std::string& key = setting.keys[depth];
      if (value->is_array())
        value = &(*value)[index_of(key, *value, place, setting, path)];
      else if (value->is_object())
        value = &member_of(*value, depth, place, setting, path);
      else
        refuse(setting, path,
               fmt::format("{} is a {} ({}), which has nothing within it that '{}' could name; give it as a whole: "
                           "--set '{}=...'",
                           place, value->type_name(), text_of_json(*value), key, place));
      place += "/" + key;
    }
    *value = setting.value;
  }
}

std::string effective_text(const Json& json, const std::vector<CaseSetting>& settings) {
  std::string text;
  for (const CaseSetting& setting : settings) text += fmt::format("// --set {}\n", text_of_json(Json(setting.text)));
  return text + text_of_json(json, 2) + "\n";
}

bool is_set(const std::string& pointer, const std::vector<CaseSetting>& settings) {
  const auto holds = [](const std::string& outer, const std::string& inner) {
    return inner.starts_with(outer) && (inner.size() == outer.size() || inner[outer.size()] == '/');
  };
  return std::any_of(settings.begin(), settings.end(), [&](const CaseSetting& setting) {
    return holds(setting.pointer, pointer) || (!pointer.empty() && holds(pointer, setting.pointer));
  });
}

void use_settings(const std::vector<std::string>& texts) {
  std::vector<CaseSetting> settings;
  for (const auto& text : texts) {
    settings.push_back(parse_setting(text));
    for (std::size_t k = 0; k + 1 < settings.size(); ++k)
      if (settings[k].keys == settings.back().keys)
        throw InputError(fmt::format("--set {}: given twice; give it once, so that it is clear which value holds",
                                     settings[k].pointer));
  }
  kept() = std::move(settings);
}

const std::vector<CaseSetting>& settings_in_use() {
  return kept();
}

std::vector<std::string> texts_of_settings() {
  std::vector<std::string> texts;
  for (const CaseSetting& setting : kept()) texts.push_back(setting.text);
  return texts;
}

std::string settings_as_options() {
  std::string options;
  for (const CaseSetting& setting : kept()) {
    std::string quoted;
    for (const char c : setting.text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    options += fmt::format(" --set '{}'", quoted);
  }
  return options;
}

}  // namespace tailrun

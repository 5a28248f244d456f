// A part of a case file: its values by key, checked (case_file.hpp).
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "common/case_file_state.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/number_text.hpp"
#include "common/warnings.hpp"

namespace tailrun {

namespace {

// What a text was meant to say in place of a number: "8 kPa" of a key in Pa.
std::string number_hint(const std::string& text, std::string_view unit) {
  std::size_t used = 0;
  const auto value = leading_number(text, used);
  if (!value) return "";
  const std::string found = text.substr(std::min(text.find_first_not_of(' ', used), text.size()));
  if (found.empty()) return fmt::format("; without quotes: {:g}", *value);
  const std::string plain = fmt::format("; write the number alone, in {}", unit == "1" ? "no unit" : unit);
  static const std::map<char, double> prefixes = {{'G', 1e9}, {'M', 1e6}, {'k', 1e3}, {'c', 1e-2}, {'m', 1e-3}};
  if (found == unit) return fmt::format("{}: {:g}", plain, *value);
  const auto prefix = prefixes.find(found.front());
  if (prefix == prefixes.end() || found.substr(1) != unit) return plain;
  return fmt::format("{}: {:g}", plain, prefix->second * *value);
}

}  // namespace

CaseNode::CaseNode(std::shared_ptr<CaseFile::State> state, const Json* json, std::string pointer)
    : state_(std::move(state)), json_(json), pointer_(std::move(pointer)) {
  if (json_ && json_->is_object()) state_->visited[pointer_] = json_;
}

void CaseNode::fail(const std::string& key, const std::string& message) const {
  const std::string place = key.empty() ? pointer_ : child(pointer_, key);
  throw InputError(
      fmt::format("{}: {}{}: {}", state_->path.string(), place.empty() ? "/" : place, state_->origin(place), message));
}

void CaseNode::warn(const std::string& key, const std::string& message) const {
  const std::string place = child(pointer_, key);
  add_warning(fmt::format("{}: {}{}: {}", state_->path.string(), place, state_->origin(place), message));
}

std::optional<double> CaseNode::peek(const std::string& key) const {
  if (!json_ || !json_->is_object()) return std::nullopt;
  const auto it = json_->find(key);
  if (it == json_->end() || !it->is_number()) return std::nullopt;
  return it->get<double>();
}

const Json* CaseNode::find(const std::string& key) const {
  state_->known[pointer_].insert(key);
  if (!json_ || !json_->is_object()) return nullptr;
  const auto it = json_->find(key);
  return it == json_->end() ? nullptr : &*it;
}

const Json& CaseNode::require(const std::string& key, std::string_view wanted) const {
  const Json* value = find(key);
  if (value) return *value;
  std::vector<std::string> strangers;
  if (json_ && json_->is_object())
    for (const auto& [name, unused] : json_->items())
      if (!state_->known[pointer_].contains(name)) strangers.push_back(name);
  const std::string near = nearest(key, strangers);
  fail(key, fmt::format("missing; {} is required{}", wanted,
                        near.empty() ? "" : fmt::format(" (found '{}' instead)", near)));
}

void CaseNode::record(const std::string& key, const std::string& value, std::string_view unit,
                      const std::optional<std::string>& fallback) const {
  const std::string place = child(pointer_, key);
  const std::string origin = state_->origin(place);
  std::string line =
      fmt::format("{} = {}{}", place.substr(1), value, unit.empty() || unit == "1" ? "" : fmt::format(" {}", unit));
  if (fallback && !find(key))
    line += "  (default)";
  else
    line += (origin.empty() ? "" : " " + origin) +
            (fallback && *fallback != value ? fmt::format("  (default: {})", *fallback) : "");
  // What is read for several things is told once.
  if (std::find(state_->echo.begin(), state_->echo.end(), line) == state_->echo.end())
    state_->echo.push_back(std::move(line));
}

double CaseNode::checked(const std::string& key, const Json& value, std::string_view unit, Range range) const {
  if (!value.is_number())
    fail(key, fmt::format("found {}, but a number [{}] in {} is required{}", kind(value), unit, range.text(),
                          value.is_string() ? number_hint(value.get<std::string>(), unit) : ""));
  const double number = value.get<double>();
  if (!std::isfinite(number) || !range.contains(number))
    fail(key, fmt::format("found {:g}, but allowed is {} [{}]", number, range.text(), unit));
  return number;
}

double CaseNode::number(const std::string& key, std::string_view unit, Range range) const {
  const double value = checked(key, require(key, fmt::format("a number [{}] in {}", unit, range.text())), unit, range);
  record(key, fmt::format("{:g}", value), unit);
  return value;
}

double CaseNode::number_or(const std::string& key, std::string_view unit, Range range, double fallback) const {
  const Json* json = find(key);
  const double value = json ? checked(key, *json, unit, range) : fallback;
  record(key, fmt::format("{:g}", value), unit, fmt::format("{:g}", fallback));
  return value;
}

std::optional<double> CaseNode::number_if(const std::string& key, std::string_view unit, Range range) const {
  if (!find(key)) return std::nullopt;
  return number(key, unit, range);
}

long CaseNode::whole_number(const std::string& key, long low, long high) const {
  const Json& json = require(key, fmt::format("an integer in [{}, {}]", low, high));
  // Above the range of long the library would wrap round.
  const bool beyond = json.is_number_unsigned() &&
                      json.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<long>::max());
  if (!json.is_number_integer() || beyond || json.get<long>() < low || json.get<long>() > high)
    fail(key, fmt::format("found {}, but an integer in [{}, {}] is required", kind(json), low, high));
  return json.get<long>();
}

long CaseNode::integer(const std::string& key, long low, long high) const {
  const long value = whole_number(key, low, high);
  record(key, std::to_string(value), "");
  return value;
}

long CaseNode::integer_or(const std::string& key, long low, long high, long fallback) const {
  const long value = find(key) ? whole_number(key, low, high) : fallback;
  record(key, std::to_string(value), "", std::to_string(fallback));
  return value;
}

bool CaseNode::boolean_or(const std::string& key, bool fallback) const {
  const Json* json = find(key);
  if (json && !json->is_boolean()) fail(key, fmt::format("found {}, but true or false is required", kind(*json)));
  const bool value = json ? json->get<bool>() : fallback;
  record(key, value ? "true" : "false", "", fallback ? "true" : "false");
  return value;
}

std::string CaseNode::plain_text(const std::string& key) const {
  const Json& json = require(key, "a text");
  if (!json.is_string()) fail(key, fmt::format("found {}, but a text is required", kind(json)));
  return json.get<std::string>();
}

std::string CaseNode::text(const std::string& key) const {
  const std::string value = plain_text(key);
  record(key, value, "");
  return value;
}

std::string CaseNode::text_or(const std::string& key, const std::string& fallback) const {
  const bool given = find(key) != nullptr;
  const std::string value = given ? plain_text(key) : fallback;
  record(key, value, "", given && fallback.empty() ? std::nullopt : std::optional(fallback));
  return value;
}

std::string CaseNode::word_of(const std::string& key, const std::vector<std::string>& allowed) const {
  const Json& json = require(key, "one of " + joined(allowed));
  if (!json.is_string()) fail(key, fmt::format("found {}, but one of {} is required", kind(json), joined(allowed)));
  const auto value = json.get<std::string>();
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return value;
  fail(key,
       fmt::format("found '{}', but allowed is one of {}.{}", value, joined(allowed), did_you_mean(value, allowed)));
}

std::string CaseNode::choice(const std::string& key, const std::vector<std::string>& allowed) const {
  const std::string value = word_of(key, allowed);
  record(key, value, "");
  return value;
}

std::string CaseNode::choice_or(const std::string& key, const std::vector<std::string>& allowed,
                                const std::string& fallback) const {
  const std::string value = find(key) ? word_of(key, allowed) : fallback;
  record(key, value, "", fallback);
  return value;
}

std::vector<double> CaseNode::list_of_numbers(const std::string& key, std::string_view unit, Range range,
                                              std::size_t count) const {
  const std::string wanted =
      count ? fmt::format("a list of {} numbers [{}]", count, unit) : fmt::format("a list of numbers [{}]", unit);
  const Json& json = require(key, wanted);
  if (!json.is_array() || (count && json.size() != count))
    fail(key, fmt::format("found {}, but {} is required", kind(json), wanted));
  std::vector<double> values;
  for (std::size_t i = 0; i < json.size(); ++i)
    values.push_back(checked(child(key, std::to_string(i)), json[i], unit, range));
  return values;
}

std::vector<double> CaseNode::numbers(const std::string& key, std::string_view unit, Range range,
                                      std::size_t count) const {
  std::vector<double> values = list_of_numbers(key, unit, range, count);
  record(key, find(key)->dump(), unit);
  return values;
}

std::vector<double> CaseNode::numbers_or(const std::string& key, std::string_view unit, Range range,
                                         const std::vector<double>& fallback, std::size_t count) const {
  std::vector<double> values = find(key) ? list_of_numbers(key, unit, range, count) : fallback;
  record(key, text_of_json(Json(values)), unit, text_of_json(Json(fallback)));
  return values;
}

std::vector<std::string> CaseNode::texts_or(const std::string& key, const std::vector<std::string>& fallback) const {
  const Json* json = find(key);
  const auto wrong = [&](const Json& value) { return !value.is_string(); };
  if (json && (!json->is_array() || std::any_of(json->begin(), json->end(), wrong)))
    fail(key, fmt::format("found {}, but a list of texts is required", kind(*json)));
  const auto values = json ? json->get<std::vector<std::string>>() : fallback;
  record(key, text_of_json(Json(values)), "", text_of_json(Json(fallback)));
  return values;
}

std::vector<double> CaseNode::table(const std::string& key, std::string_view unit, std::size_t columns) const {
  const std::string wanted = fmt::format("a list of rows of {} numbers [{}]", columns, unit);
  const Json& json = require(key, wanted);
  if (!json.is_array()) fail(key, fmt::format("found {}, but {} is required", kind(json), wanted));
  std::vector<double> values;
  for (std::size_t row = 0; row < json.size(); ++row) {
    const std::string place = child(key, std::to_string(row));
    if (!json[row].is_array() || json[row].size() != columns)
      fail(place, fmt::format("found {}, but {} numbers [{}] are required", kind(json[row]), columns, unit));
    for (const auto& value : json[row]) values.push_back(checked(place, value, unit, Range::any()));
  }
  record(key, fmt::format("{} rows", json.size()), unit);
  return values;
}

std::filesystem::path CaseNode::file(const std::string& key) const {
  const std::filesystem::path given = text(key);
  const std::filesystem::path path = given.is_absolute() ? given : state_->path.parent_path() / given;
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status))
    fail(key, fmt::format("found '{}', but there is no file {} (paths are relative to the case file's folder)",
                          given.string(), path.string()));
  if (!std::filesystem::is_regular_file(status))
    fail(key, fmt::format("found '{}', but {} is no file", given.string(), path.string()));
  state_->inputs.push_back(path);
  return path;
}

CaseNode CaseNode::object(const std::string& key) const {
  const Json& json = require(key, "an object {...}");
  if (!json.is_object()) fail(key, fmt::format("found {}, but an object {{...}} is required", kind(json)));
  return CaseNode(state_, &json, child(pointer_, key));
}

std::optional<CaseNode> CaseNode::object_if(const std::string& key) const {
  if (!find(key)) return std::nullopt;
  return object(key);
}

CaseNode CaseNode::object_or_empty(const std::string& key) const {
  return find(key) ? object(key) : CaseNode(state_, nullptr, child(pointer_, key));
}

std::vector<CaseNode> CaseNode::elements(const std::string& key, const Json& json) const {
  if (!json.is_array()) fail(key, fmt::format("found {}, but a list of objects is required", kind(json)));
  std::vector<CaseNode> nodes;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string place = child(key, std::to_string(i));
    if (!json[i].is_object()) fail(place, fmt::format("found {}, but an object {{...}} is required", kind(json[i])));
    nodes.push_back(CaseNode(state_, &json[i], child(pointer_, place)));
  }
  return nodes;
}

std::vector<CaseNode> CaseNode::list(const std::string& key) const {
  return elements(key, require(key, "a list of objects"));
}

std::vector<CaseNode> CaseNode::list_or_empty(const std::string& key) const {
  const Json* json = find(key);
  return json ? elements(key, *json) : std::vector<CaseNode>{};
}

std::vector<std::pair<std::string, CaseNode>> CaseNode::members() const {
  std::vector<std::pair<std::string, CaseNode>> nodes;
  if (!json_) return nodes;
  for (const auto& [name, value] : json_->items()) nodes.emplace_back(name, object(name));
  return nodes;
}

std::vector<std::string> CaseNode::keys() const {
  std::vector<std::string> names;
  if (json_)
    for (const auto& [name, value] : json_->items()) names.push_back(name);
  return names;
}

bool CaseNode::has(const std::string& key) const {
  return find(key) != nullptr;
}

bool CaseNode::is_number(const std::string& key) const {
  const Json* json = find(key);
  return json && json->is_number();
}

bool CaseNode::is_list(const std::string& key) const {
  const Json* json = find(key);
  return json && json->is_array();
}

void require_size(const CaseNode& node, const std::string& size) {
  const std::vector<std::string> sizes = node.object_or_empty("sizes").keys();
  if (sizes.empty() || size.empty() || size == "default") return;
  if (std::find(sizes.begin(), sizes.end(), size) == sizes.end())
    node.fail("sizes", fmt::format("has no '{}' (asked for by --size).{} It has: {}", size, did_you_mean(size, sizes),
                                   joined(sizes)));
}

}  // namespace tailrun

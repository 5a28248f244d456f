#include "common/json_text.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <vector>

#include "common/error.hpp"

namespace tailrun {
namespace {

using Json = nlohmann::ordered_json;

// Far beyond any case file; messages print values by recursion, which must not run out of stack.
constexpr int deepest = 100;

// Follows the parser through the text and knows where it is.
class Place {
 public:
  explicit Place(const std::filesystem::path& path) : path_(path) {}

  void step(int depth, Json::parse_event_t event, const Json& parsed) {
    using Event = Json::parse_event_t;
    switch (event) {
      case Event::object_start:
      case Event::array_start:
        if (depth >= deepest) fail(fmt::format("nested deeper than {} levels", deepest));
        levels_.push_back({event == Event::array_start, 0, {}, {}});
        break;
      case Event::key:
        levels_.back().key = parsed.get<std::string>();
        if (!levels_.back().keys.insert(levels_.back().key).second)
          fail("this key is there twice; give it once, so that it is clear which value holds");
        break;
      case Event::object_end:
      case Event::array_end:
        levels_.pop_back();
        next();
        break;
      case Event::value:
        next();
        break;
    }
  }

  // Where the value that is being read belongs.
  std::string pointer() const {
    std::string text;
    const std::size_t shown = std::min<std::size_t>(levels_.size(), 8);
    for (std::size_t k = 0; k < shown; ++k)
      text += "/" + (levels_[k].is_list ? std::to_string(levels_[k].index) : levels_[k].key);
    if (shown < levels_.size()) text += "/...";
    return text.empty() ? "/" : text;
  }

 private:
  struct Level {
    bool is_list;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };
  void next() {
    if (!levels_.empty()) ++levels_.back().index;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}: {}", path_.string(), pointer(), message));
  }

  const std::filesystem::path& path_;
  std::vector<Level> levels_;
};

std::string line_and_column(const std::string& text, std::size_t byte) {
  const std::size_t end = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n') + 1;
  const std::size_t start = text.rfind('\n', end == 0 ? 0 : end - 1);
  return fmt::format("line {}, column {}", line, end - (start == std::string::npos || end == 0 ? 0 : start + 1) + 1);
}

char last_before(const std::string& text, std::size_t end) {
  while (end > 0 && std::string(" \t\r\n").find(text[end - 1]) != std::string::npos) --end;
  return end > 0 ? text[end - 1] : '\0';
}

// The library names what it found and expected in the grammar's words; the common slips get a name of their own.
std::string words_for(const nlohmann::json::parse_error& error, const std::string& text) {
  const std::string message = error.what();
  const std::size_t at = error.byte > 0 ? std::min(error.byte - 1, text.size()) : 0;
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return "the file is empty";
  if (message.find("invalid UTF-8") != std::string::npos || message.find("ill-formed UTF-8") != std::string::npos)
    return "a character that is not UTF-8; save the file as UTF-8";
  if (message.find("unexpected end of input") != std::string::npos || at >= text.size())
    return message.find("missing closing quote") != std::string::npos
               ? "a text is not closed by '\"'"
               : "the file ends too early: a closing '}', ']' or '\"' is missing";
  const char found = text[at], before = last_before(text, at);
  if ((found == '}' || found == ']') && before == ',') return "a comma before the closing bracket; leave it out";
  if (message.ends_with("expected '}'") || message.ends_with("expected ']'") ||
      message.ends_with("expected end of input"))
    return "a comma or a closing bracket is missing before what ends here, or there is one too many";
  if (found == '\'') return "a text must be in double quotes";
  if (message.find("expected ':'") != std::string::npos || message.find("object separator") != std::string::npos)
    return fmt::format("found '{}' where the ':' after a key is required", found);
  if (message.find("object key") != std::string::npos)
    return fmt::format("found '{}' where a key in double quotes is required", found);
  if (message.find("invalid literal") != std::string::npos)
    return fmt::format(
        "near '{}': not a number, text, true, false, null, list or object (numbers have a point, no "
        "comma; NaN and Infinity are not allowed)",
        found);
  if (message.find("invalid number") != std::string::npos)
    return "not a number as JSON writes it (0.5, not .5 or 5.; no leading +)";
  if (message.find("control character") != std::string::npos ||
      message.find("missing closing quote") != std::string::npos)
    return "a text is not closed by '\"' on its line, or holds a control character";
  const std::size_t detail = message.rfind(" - ");
  return detail == std::string::npos ? "cannot be read here" : message.substr(detail + 3);
}

}  // namespace

Json parse_json(const std::filesystem::path& path, const std::string& text) {
  Place place(path);
  try {
    return Json::parse(
        text,
        [&](int depth, Json::parse_event_t event, Json& parsed) {
          place.step(depth, event, parsed);
          return true;
        },
        true, /*ignore_comments=*/true);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(fmt::format("{}: not valid JSON: {}: {}", path.string(), line_and_column(text, error.byte),
                                 words_for(error, text)));
  } catch (const nlohmann::json::out_of_range&) {
    throw InputError(
        fmt::format("{}: {}: a number beyond the range of double (1.8e308)", path.string(), place.pointer()));
  }
}

nlohmann::ordered_json json_or_null(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  return json.is_discarded() ? Json() : json;
}

std::string text_of_json(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

bool is_utf8(const std::string& text) {
  try {
    Json(text).dump();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
  return true;
}

}  // namespace tailrun

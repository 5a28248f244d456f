#include "common/motion_units.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

namespace tailrun {
namespace {

constexpr const char* second_words = "(?:SECONDS|SECOND|SECS|SEC|S)";

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::toupper(c); });
  return out;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\"'");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\"'") - first + 1);
}

// Upper case, one way of writing powers and "per".
std::string normalised(std::string_view text) {
  std::string out = upper(text);
  for (const auto& [from, to] : {std::pair{"\u00b2", "2"}, std::pair{"\u207b", "-"}, std::pair{"\u00b7", " "}})
    for (std::size_t at; (at = out.find(from)) != std::string::npos;) out.replace(at, std::string(from).size(), to);
  static const std::regex per(R"(\s+PER\s+)"), blanks(R"(\s*([/*^])\s*)"), power(R"(\*\*\+?|\^\+?)"),
      square(R"([- ](?:SQ|SQUARED)\b)"), of_gravity(R"(^(?:FRACTIONS? OF|TERMS OF|MULTIPLES OF)\s+)");
  out = std::regex_replace(out, per, "/");
  out = std::regex_replace(out, blanks, "$1");
  out = std::regex_replace(out, power, "");
  out = std::regex_replace(out, square, "2");
  return std::regex_replace(out, of_gravity, "");
}

double length_factor(const std::string& word) {
  if (word == "MM") return 1e-3;
  if (word == "CM" || word.rfind("CENTI", 0) == 0) return 1e-2;
  if (word == "IN" || word.rfind("INCH", 0) == 0) return 0.0254;
  if (word == "FT" || word.rfind("F", 0) == 0) return 0.3048;
  return 1.0;
}

// "M_S2" of a column's name to "M/S2", "MPS2" to "M/S2".
std::string suffix_as_unit(std::string suffix) {
  static const std::regex under(R"(^(MM|CM|M|IN|FT)_?(?:P|PER_?)?_?(SEC|S)_?(2|-2)?$)");
  std::smatch match;
  suffix = upper(suffix);
  if (std::regex_match(suffix, match, under) && suffix != "MS")
    return match[1].str() + "/" + match[2].str() + (match[3].matched ? "2" : "");
  return suffix;
}

}  // namespace

const char* const known_acceleration_units = "m/s2, cm/s2, mm/s2, gal, g, mg, %g, ft/s2, in/s2";

std::optional<MotionUnit> motion_unit(std::string_view text, bool whole) {
  const std::string line = normalised(trimmed(std::string(text)));
  const std::string end = whole ? "[.,;)\\]]*$" : "(?![A-Z0-9])";
  static const std::string length = "(MM|CM|M|METERS?|METRES?|CENTIMETERS?|CENTIMETRES?|INCH|INCHES|IN|FT|FOOT|FEET)";
  const std::string s = second_words;
  // Making an expression takes far longer than looking with it.
  thread_local std::map<std::string, std::regex> made;
  const auto found = [&](const std::string& pattern, std::smatch& match) {
    const std::string whole_pattern = "^(?:" + pattern + ")" + end;
    auto at = made.find(whole_pattern);
    if (at == made.end()) at = made.emplace(whole_pattern, std::regex(whole_pattern)).first;
    return std::regex_search(line, match, at->second);
  };
  std::smatch match;
  const auto unit = [&](MotionQuantity quantity, double factor) {
    return MotionUnit{quantity, factor, match[0].str()};
  };
  using enum MotionQuantity;
  if (found("(?:%|PERCENT) ?(?:OF )?G", match)) return unit(acceleration, 0.01 * standard_gravity);
  if (found("MG|MILLI-?G", match)) return unit(acceleration, 1e-3 * standard_gravity);
  if (found("G|G'S|GS", match)) return unit(acceleration, standard_gravity);
  if (found("GALS?", match)) return unit(acceleration, 1e-2);
  if (found("MGALS?", match)) return unit(acceleration, 1e-5);
  if (found(length + "/" + s + "(?:/" + s + "|2)", match) || found(length + "[ *.]?" + s + "-2", match))
    return unit(acceleration, length_factor(match[1]));
  if (found(length + "/" + s, match) || found(length + "[ *.]" + s + "-1", match))
    return unit(velocity, length_factor(match[1]));
  if (found(length, match)) return unit(displacement, length_factor(match[1]));
  return std::nullopt;
}

std::optional<double> time_unit(std::string_view word) {
  const std::string text = upper(trimmed(std::string(word)));
  for (const char* name : {"S", "SEC", "SECS", "SECOND", "SECONDS"})
    if (text == name) return 1.0;
  for (const char* name : {"MS", "MSEC", "MSECS", "MILLISEC", "MILLISECS", "MILLISECOND", "MILLISECONDS"})
    if (text == name) return 1e-3;
  for (const char* name : {"US", "USEC", "MICROSECOND", "MICROSECONDS"})
    if (text == name) return 1e-6;
  for (const char* name : {"MIN", "MINUTE", "MINUTES"})
    if (text == name) return 60.0;
  return std::nullopt;
}

StatedUnit unit_stated_in(const std::string& line) {
  const std::string text = upper(line);
  StatedUnit out;
  std::smatch match;
  static const std::regex units(R"(\bUNITS?\b(?:\s*(?:(?:OF|ARE|IS)\b|IN\b(?!\s*/)|[:=]))*\s*[(\[]?\s*(.*)$)");
  if (std::regex_search(text, match, units)) {
    out.after_units_word = true;
    out.unit = motion_unit(match[1].str(), false);
    if (!out.unit) out.unknown = trimmed(match[1].str());
  }
  static const std::regex quantity(R"(\b(ACC|ACCEL|ACCELERATION|VEL|VELOCITY|DISP|DISPL|DISPLACEMENT)\b)");
  std::smatch word;
  if (!std::regex_search(text, word, quantity)) return out;
  const MotionQuantity named = word[1].str()[0] == 'A'   ? MotionQuantity::acceleration
                               : word[1].str()[0] == 'V' ? MotionQuantity::velocity
                                                         : MotionQuantity::displacement;
  if (!out.after_units_word) {
    static const std::regex in(R"((?:\bIN\b|[(\[,])\s*(.*)$)");
    const std::string rest = word.suffix();
    if (std::regex_search(rest, match, in)) {
      out.unit = motion_unit(match[1].str(), false);
      // "ACCELERATION IN FURLONG/S2" says a unit; "ACCELERATION IN TOKYO" does not.
      static const std::regex per_time(R"(^[A-Z%]+ ?(?:/|\bPER\b) ?(?:S|SEC|SECS|SECONDS?)(?![A-Z]).*$)");
      if (const std::string said = trimmed(match[1].str()); !out.unit && std::regex_match(said, per_time)) {
        out.after_units_word = true;
        out.unknown = said;
      }
    }
    // "VELOCITY TIME SERIES" without a unit is a statement; a velocity that the text of a station names is not.
    const bool series = std::regex_search(rest, std::regex(R"(^\s*(?:TIME\s*)?(?:SERIES|HISTORY)|^\s*$)"));
    if (!out.unit && named != MotionQuantity::acceleration && series) out.unit = MotionUnit{named, 1.0, word[1]};
  } else if (out.unit && named != MotionQuantity::acceleration) {
    out.unit->quantity = named;
  }
  return out;
}

ColumnUnit column_unit(const std::string& name) {
  ColumnUnit out;
  const std::string text = trimmed(name);
  const auto take = [&](const std::string& word) {
    out.time = time_unit(word);
    if (!out.time) out.unit = motion_unit(suffix_as_unit(word), true);
    return out.time || out.unit;
  };
  std::smatch match;
  static const std::regex brackets(R"([(\[{]\s*([^)\]}]*?)\s*[)\]}])");
  if (std::regex_search(text, match, brackets)) {
    if (!take(match[1])) out.unknown = match[1];
  } else if (!take(text)) {
    for (std::size_t at = text.find_first_of("_ /,"); at != std::string::npos; at = text.find_first_of("_ /,", at + 1))
      if (take(trimmed(text.substr(at + 1)))) break;
  }
  static const std::regex quantity(R"(^(VEL|VELOCITY|DISP|DISPLACEMENT)(?![A-Z]))");
  const std::string word = upper(text);
  if (!out.unit && !out.time && std::regex_search(word, match, quantity))
    out.unit =
        MotionUnit{match[1].str()[0] == 'V' ? MotionQuantity::velocity : MotionQuantity::displacement, 1.0, text};
  return out;
}

}  // namespace tailrun

// Reading of motions: what the file says about units and columns is followed or refused, and nothing in it is left out
// without a word.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>

#include "common/error.hpp"
#include "common/motion.hpp"
#include "common/motion_units.hpp"
#include "common/number_text.hpp"
#include "common/text_file.hpp"
#include "common/warnings.hpp"

namespace tailrun {
namespace {

using Path = std::filesystem::path;
using Lines = std::vector<std::string>;

[[noreturn]] void fail(const Path& path, std::size_t line, const std::string& message) {
  throw InputError(fmt::format("{}: line {}: {}", path.string(), line + 1, message));
}

void require_possible_step(const Path& path, std::size_t line, double step) {
  constexpr double shortest = 1e-6;  // s; recorders take 50 to 1000 values a second
  if (step < shortest)
    fail(path, line,
         fmt::format("the time step is {:g} s, but at least {:g} s is required: is the unit right?", step, shortest));
}

void integrate(const Path& path, Motion& motion) {
  motion.integrate();
  for (const double v : motion.velocity)
    if (!std::isfinite(v))
      throw InputError(
          fmt::format("{}: its accelerations add up to a velocity beyond any number; are they and their "
                      "unit right?",
                      path.string()));
}

// Of text, which is searched by regular expressions: the library's take a stack frame for each character.
constexpr std::size_t longest_text = 1000;

const std::string& text_line(const Path& path, const Lines& lines, std::size_t i) {
  if (lines[i].size() > longest_text)
    fail(path, i,
         fmt::format("has {} characters, but a line of text has at most {}; is this a motion, and do its lines end?",
                     lines[i].size(), longest_text));
  return lines[i];
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(" \t", at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string shown(std::string_view text) {
  return std::string(text.substr(0, 60)) + (text.size() > 60 ? "..." : "");
}

bool begins_like_number(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  if (first == std::string::npos) return false;
  std::size_t used = 0;
  return leading_number(std::string_view(line).substr(first), used).has_value();
}

void require_acceleration(const Path& path, std::size_t line, const MotionUnit& unit) {
  if (unit.quantity == MotionQuantity::acceleration) return;
  fail(path, line,
       fmt::format("says '{}', which is a {}, but an acceleration is required, in one of {}", unit.text,
                   unit.quantity == MotionQuantity::velocity ? "velocity" : "displacement", known_acceleration_units));
}

// Factor to m/s2 by the lines of text above the values; nothing when they do not say.
std::optional<double> stated_factor(const Path& path, const Lines& lines, const std::vector<std::size_t>& header) {
  std::optional<double> factor;
  std::optional<std::pair<std::size_t, MotionUnit>> other;  // not after "units"; an acceleration goes first
  for (const std::size_t i : header) {
    const StatedUnit stated = unit_stated_in(lines[i]);
    if (stated.after_units_word) {
      if (!stated.unit)
        fail(path, i,
             fmt::format("says the unit is '{}', but known are {}", shown(stated.unknown), known_acceleration_units));
      require_acceleration(path, i, *stated.unit);
      if (factor && *factor != stated.unit->factor) fail(path, i, "says another unit than a line above it");
      factor = stated.unit->factor;
    } else if (stated.unit && (!other || other->second.quantity != MotionQuantity::acceleration)) {
      other = {i, *stated.unit};
    }
  }
  if (factor || !other) return factor;
  require_acceleration(path, other->first, other->second);
  return other->second.factor;
}

struct Counts {
  std::size_t line = 0, values = 0;
  double time_step = 0.0;  // s
};

std::optional<Counts> counts_in(const Path& path, const std::string& header, std::size_t line) {
  static const std::regex count(R"(\bNPTS\s*[=:]\s*(\d{1,9})(?![\d.]))", std::regex::icase),
      step(R"(\bDT\s*[=:]\s*)", std::regex::icase),
      old(R"(^\s*(\d{1,9})\s+(\S+?)\s*,?\s+NPTS\s*,?\s*DT\b\s*,?)", std::regex::icase);
  Counts out{line, 0, 0.0};
  std::smatch match;
  std::string rest;
  if (std::regex_search(header, match, count)) {
    out.values = std::stoul(match[1]);
    if (!std::regex_search(header, match, step)) return std::nullopt;
    rest = match.suffix();
  } else if (std::regex_search(header, match, old)) {
    out.values = std::stoul(match[1]);
    rest = match[2].str() + " " + match.suffix().str();
  } else {
    return std::nullopt;
  }
  std::size_t used = 0;
  const auto value = leading_number(rest, used);
  if (!value) fail(path, line, fmt::format("the time step '{}' is not a number", shown(rest)));
  const std::string after = rest.substr(used);
  if (!after.empty() && std::string(" \t,;").find(after[0]) == std::string::npos &&
      !std::isalpha(static_cast<unsigned char>(after[0])) && after[0] != '(')
    fail(path, line, fmt::format("the time step '{}' is not a number", shown(rest)));
  const auto first = after.find_first_not_of(" \t,;(=");
  std::string word = first == std::string::npos ? "" : after.substr(first);
  word = word.substr(0, word.find_first_of(" \t,;).="));
  double factor = 1.0;
  if (!word.empty() && std::isalpha(static_cast<unsigned char>(word[0])) &&
      !std::regex_match(word, std::regex("NPTS", std::regex::icase))) {
    const auto unit = time_unit(word);
    if (!unit) fail(path, line, fmt::format("'{}' after the time step is no unit of time: s or ms is required", word));
    factor = *unit;
  }
  out.time_step = factor * *value;
  if (!(out.time_step > 0.0)) fail(path, line, "the time step must be positive");
  require_possible_step(path, line, out.time_step);
  return out;
}

// Separators of a row: commas or semicolons where there are any, else blanks.
std::vector<std::string> cells_of(const Path& path, std::size_t line, const std::string& text, bool header) {
  const bool commas = text.find(',') != std::string::npos, semicolons = text.find(';') != std::string::npos;
  if (commas && semicolons && !header)
    fail(path, line, fmt::format("'{}' has decimal commas; write decimal points", shown(text)));
  std::vector<std::string> cells;
  if (commas || semicolons || text.find('\t') != std::string::npos) {
    const char separator = semicolons ? ';' : commas ? ',' : '\t';
    for (std::size_t at = 0;;) {
      const auto next = text.find(separator, at);
      std::string cell = text.substr(at, next - at);
      const auto first = cell.find_first_not_of(" \t\"");
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(" \t\"") - first + 1));
      if (next == std::string::npos) break;
      at = next + 1;
    }
    while (cells.size() > 2 && cells.back().empty()) cells.pop_back();  // a comma at the line's end
  } else {
    if (!header) return words_of(text);
    static const std::regex word(R"([^\s([]*(?:\s*[(\[][^)\]]*[)\]])|\S+)");
    for (std::sregex_iterator it(text.begin(), text.end(), word), last; it != last; ++it) cells.push_back(it->str());
  }
  return cells;
}

struct Columns {
  double time = 1.0, acceleration = 1.0;  // factors to s and m/s2
};

// The last line above the values names the columns; the lines before it are comments that may say a unit.
Columns columns_of(const Path& path, const Lines& lines, const std::vector<std::size_t>& header) {
  Columns out;
  if (const auto factor = stated_factor(path, lines, header)) out.acceleration = *factor;
  if (header.empty()) return out;
  const std::size_t line = header.back();
  std::string text = lines[line];
  text.erase(0, std::min(text.find_first_not_of(" \t#%"), text.size()));
  if (unit_stated_in(text).after_units_word) return out;
  const auto cells = cells_of(path, line, text, true);
  if (cells.size() < 2) return out;
  const ColumnUnit first = column_unit(cells[0]), second = column_unit(cells[1]);
  // Free text with a comma in it names no columns.
  const bool names = cells.size() == 2 || first.time || text.find(',') != std::string::npos;
  if (!names) return out;
  if (cells.size() > 2 && lines[line].find_first_of("#%") == std::string::npos)
    fail(path, line,
         fmt::format("names {} columns ('{}' is the third), but two are required: time and acceleration; keep the one "
                     "that is meant",
                     cells.size(), cells[2]));
  if (cells.size() > 2) return out;
  if (!first.unknown.empty() || first.unit)
    fail(path, line, fmt::format("the first column is '{}', but a time in s or ms is required", cells[0]));
  if (!second.unknown.empty())
    fail(path, line,
         fmt::format("the unit '{}' of column '{}' is not known; allowed are {}", second.unknown, cells[1],
                     known_acceleration_units));
  if (first.time) out.time = *first.time;
  if (second.unit) {
    require_acceleration(path, line, *second.unit);
    out.acceleration = second.unit->factor;
  }
  return out;
}

}  // namespace

Motion read_at2(const Path& path) {
  const Lines lines = read_lines(path, "a motion");
  std::optional<Counts> counts;
  std::vector<std::size_t> header;
  for (std::size_t i = 0; i < std::min<std::size_t>(lines.size(), 12) && !counts; ++i) {
    counts = counts_in(path, text_line(path, lines, i), i);
    if (!counts) header.push_back(i);
  }
  if (!counts)
    throw InputError(
        fmt::format("{}: line 4: found '{}', but 'NPTS= n, DT= s SEC' or 'n dt NPTS, DT' is required there or in one "
                    "of the lines around it",
                    path.string(), lines.size() > 3 ? shown(lines[3]) : ""));
  Motion motion;
  motion.name = path.filename().string();
  motion.time_step = counts->time_step;
  std::size_t i = counts->line + 1;
  for (; i < lines.size() && i < counts->line + 6 && !begins_like_number(lines[i]); ++i) {
    text_line(path, lines, i);
    header.push_back(i);
  }
  const auto stated = stated_factor(path, lines, header);
  if (!stated) add_warning(fmt::format("{}: no line above the values says their unit; g is taken", path.string()));
  const double factor = stated.value_or(standard_gravity);
  for (; i < lines.size(); ++i) {
    std::string_view bad;
    const auto values = fortran_numbers(lines[i], bad);
    if (!values) fail(path, i, fmt::format("'{}' is not a number", bad));
    for (const double value : *values) motion.acceleration.push_back(factor * value);
  }
  if (motion.acceleration.size() < counts->values)
    throw InputError(fmt::format("{}: line {} promises {} values, but only {} follow; the file is cut short",
                                 path.string(), counts->line + 1, counts->values, motion.acceleration.size()));
  if (motion.acceleration.size() > counts->values) {
    add_warning(fmt::format("{}: line {} promises {} values, {} follow; the surplus is ignored", path.string(),
                            counts->line + 1, counts->values, motion.acceleration.size()));
    motion.acceleration.resize(counts->values);
  }
  if (motion.acceleration.size() < 2)
    throw InputError(
        fmt::format("{}: has {} values, but at least two are required", path.string(), motion.acceleration.size()));
  integrate(path, motion);
  return motion;
}

Motion read_motion_csv(const Path& path) {
  Motion motion;
  motion.name = path.filename().string();
  const Lines lines = read_lines(path, "a motion");
  std::vector<std::size_t> header;
  std::size_t i = 0;
  for (; i < std::min<std::size_t>(lines.size(), 50) && !begins_like_number(lines[i]); ++i)
    if (text_line(path, lines, i).find_first_not_of(" \t") != std::string::npos) header.push_back(i);
  const Columns columns = columns_of(path, lines, header);
  std::vector<double> times;
  std::vector<std::size_t> rows;
  for (; i < lines.size(); ++i) {
    if (lines[i].find_first_not_of(" \t,;") == std::string::npos) continue;
    const auto cells = cells_of(path, i, lines[i], false);
    if (cells.size() > 2)
      fail(path, i,
           fmt::format("found {} columns, but two are required: time and acceleration; keep the one that is meant",
                       cells.size()));
    for (std::size_t k = 0; k < 2; ++k)
      if (k >= cells.size() || cells[k].empty())
        fail(path, i, fmt::format("'{}' has no {}", shown(lines[i]), k == 0 ? "time" : "acceleration"));
    const auto time = number_of(cells[0]), acceleration = number_of(cells[1]);
    if (!time || !acceleration) fail(path, i, fmt::format("'{}' is not a number", shown(time ? cells[1] : cells[0])));
    times.push_back(columns.time * *time);
    motion.acceleration.push_back(columns.acceleration * *acceleration);
    rows.push_back(i);
  }
  if (times.size() < 2)
    throw InputError(fmt::format("{}: at least two rows 'time [s], acceleration [m/s2]' are required", path.string()));
  motion.time_step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double expected = times.front() + motion.time_step * static_cast<double>(k);
    if (!(motion.time_step > 0.0) || std::abs(times[k] - expected) > 0.01 * motion.time_step)
      fail(path, rows[k],
           fmt::format("time {:g} s, but a uniform time step ({:g} s) is required", times[k], motion.time_step));
  }
  require_possible_step(path, rows.front(), motion.time_step);
  if (std::abs(times.front()) > 0.5 * motion.time_step)
    add_warning(fmt::format("{}: begins at {:g} s; the motion is moved to begin at 0", path.string(), times.front()));
  integrate(path, motion);
  return motion;
}

Motion read_motion(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".at2") return read_at2(path);
  if (extension == ".csv" || extension == ".txt") return read_motion_csv(path);
  throw InputError(fmt::format("{}: a motion is a PEER .AT2 file or a two-column .csv, found extension '{}'",
                               path.string(), extension));
}

}  // namespace tailrun

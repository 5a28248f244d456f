#include "transfer_tool/import/csv_table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/error.hpp"
#include "common/number_text.hpp"
#include "common/text_file.hpp"

namespace tailrun::transfer {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t start = 0;;) {
    const std::size_t comma = line.find(',', start);
    cells.push_back(trimmed(line.substr(start, comma == std::string::npos ? comma : comma - start)));
    if (comma == std::string::npos) return cells;
    start = comma + 1;
  }
}

// Words of units as they stand behind a column's name, with their factor to SI. Longer ones come first, so that "cm_s"
// is not taken for "s" of a column "..._cm".
struct Unit {
  std::string word;
  Quantity quantity;
  double to_si;
};

const std::vector<Unit>& units() {
  using enum Quantity;
  constexpr double foot = 0.3048, inch = 0.0254, pound = 4.4482216152605, g = 9.81;
  static const std::vector<Unit> known = [&] {
    std::vector<Unit> list = {{"kPa", pressure, 1e3},
                              {"MPa", pressure, 1e6},
                              {"GPa", pressure, 1e9},
                              {"Pa", pressure, 1.0},
                              {"N_m2", pressure, 1.0},
                              {"kN_m2", pressure, 1e3},
                              {"MN_m2", pressure, 1e6},
                              {"N_mm2", pressure, 1e6},
                              {"bar", pressure, 1e5},
                              {"psi", pressure, pound / (inch * inch)},
                              {"ksi", pressure, 1e3 * pound / (inch * inch)},
                              {"psf", pressure, pound / (foot * foot)},
                              {"ksf", pressure, 1e3 * pound / (foot * foot)},
                              {"kgf_cm2", pressure, 98066.5},
                              {"t_m2", pressure, 9806.65},
                              {"tf_m2", pressure, 9806.65},
                              {"gal", acceleration, 1e-2},
                              {"Gal", acceleration, 1e-2},
                              {"g", acceleration, g},
                              {"percent", strain, 1e-2},
                              {"%", strain, 1e-2},
                              {"1", strain, 1.0}};
    for (const auto& [word, metres] : std::vector<std::pair<std::string, double>>{
             {"m", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"ft", foot}, {"in", inch}}) {
      list.push_back({word, length, metres});
      list.push_back({word + "_s", velocity, metres});
      list.push_back({word + "_s2", acceleration, metres});
    }
    std::stable_sort(list.begin(), list.end(),
                     [](const Unit& a, const Unit& b) { return a.word.size() > b.word.size(); });
    return list;
  }();
  return known;
}

const char* name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::number:
      return "a number without unit";
    case Quantity::length:
      return "a length";
    case Quantity::velocity:
      return "a velocity";
    case Quantity::acceleration:
      return "an acceleration";
    case Quantity::pressure:
      return "a stress";
    case Quantity::strain:
      return "a strain";
  }
  return "";
}

std::string words_of(Quantity quantity) {
  std::vector<std::string> words;
  for (const Unit& unit : units())
    if (unit.quantity == quantity) words.push_back(unit.word);
  return joined(words);
}

// "m/s^2", "kN/m2", "m/s**2" as "m_s2", "kN_m2".
std::string as_word(std::string unit) {
  std::string word;
  for (const char c : unit)
    if (c == '/')
      word += '_';
    else if (c != '^' && c != '*' && c != ' ')
      word += c;
  return word;
}

// The first line names the columns: one with a number in it is a row of a table whose header was left out, one without
// commas but with another separator would be one column of that long name.
void require_header(const std::filesystem::path& path, const std::string& line,
                    const std::vector<std::string>& headers) {
  if (std::any_of(headers.begin(), headers.end(), [](const auto& cell) { return number_of(cell).has_value(); }))
    throw InputError(
        fmt::format("{}: line 1: found a number ('{}'), but a header line with the columns' names is required",
                    path.string(), line));
  for (const auto& [separator, name] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}})
    if (headers.size() == 1 && headers.front().find(separator) != std::string::npos)
      throw InputError(fmt::format("{}: line 1: found columns separated by {} ('{}'), but commas are required{}",
                                   path.string(), name, line,
                                   separator == ';' ? " (and decimal points, not decimal commas)" : ""));
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& path) : path_(path) {
  const std::vector<std::string> lines = read_lines(path, "a table (CSV)");
  const auto headers = split(lines.front());
  require_header(path, lines.front(), headers);
  for (const auto& header : headers) {
    Column column{header, header, ""};
    const std::size_t bracket = header.find_first_of("[(");
    if (bracket != std::string::npos && bracket > 0 && (header.back() == ']' || header.back() == ')')) {
      column.name = trimmed(header.substr(0, bracket));
      column.unit = as_word(header.substr(bracket + 1, header.size() - bracket - 2));
    } else {
      for (const Unit& unit : units())
        if (header.size() > unit.word.size() + 1 && header.ends_with("_" + unit.word)) {
          column.name = header.substr(0, header.size() - unit.word.size() - 1);
          column.unit = unit.word;
          break;
        }
    }
    for (const Column& other : columns_)
      if (other.name == column.name)
        throw InputError(
            fmt::format("{}: line 1: columns '{}' and '{}' are the same quantity; keep the one that is meant",
                        path.string(), other.header, column.header));
    columns_.push_back(std::move(column));
  }
  for (std::size_t number = 2; number <= lines.size(); ++number) {
    auto cells = split(lines[number - 1]);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() != columns_.size())
      throw InputError(fmt::format("{}: line {} has {} cells, but the header has {}", path.string(), number,
                                   cells.size(), columns_.size()));
    rows_.push_back(std::move(cells));
    lines_.push_back(number);
  }
}

void CsvTable::fail(std::size_t row, const std::string& name, const std::string& message) const {
  throw InputError(fmt::format("{}: line {}, column '{}': {}", path_.string(), lines_[row], name, message));
}

const CsvTable::Column* CsvTable::find(const std::string& name) {
  asked_.insert(name);
  for (const Column& column : columns_)
    if (column.name == name || column.header == name) return &column;
  return nullptr;
}

std::size_t CsvTable::require(const std::string& name) {
  if (const Column* column = find(name)) return static_cast<std::size_t>(column - columns_.data());
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.header);
  throw InputError(
      fmt::format("{}: no column '{}'.{} Found: {}", path_.string(), name, did_you_mean(name, names), joined(names)));
}

bool CsvTable::has(const std::string& name) {
  return find(name) != nullptr;
}

double CsvTable::factor(const Column& column, Quantity quantity) const {
  if (column.unit.empty() || column.header == column.unit) return 1.0;
  const Unit* found = nullptr;
  for (const Unit& unit : units())
    if (unit.word == column.unit) found = &unit;
  if (found && found->quantity == quantity) return found->to_si;
  throw InputError(fmt::format("{}: line 1, column '{}': {} '{}', but {} is required here ({})", path_.string(),
                               column.header, found ? "its unit is" : "does not know the unit", column.unit,
                               name_of(quantity), quantity == Quantity::number ? "no unit" : words_of(quantity)));
}

std::vector<double> CsvTable::numbers(const std::string& name, Quantity quantity) {
  const std::size_t index = require(name);
  const double to_si = factor(columns_[index], quantity);
  std::vector<double> values;
  values.reserve(rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string& cell = rows_[row][index];
    const char* begin = cell.data() + (cell.size() > 1 && cell[0] == '+' && cell[1] != '-');
    double value = 0.0;
    const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value))
      fail(row, name, fmt::format("found '{}', but a finite number is required", cell));
    values.push_back(value * to_si);
  }
  return values;
}

std::vector<double> CsvTable::numbers_or(const std::string& name, Quantity quantity, double fallback) {
  return has(name) ? numbers(name, quantity) : std::vector<double>(rows(), fallback);
}

std::vector<std::int64_t> CsvTable::integers(const std::string& name) {
  const std::size_t index = require(name);
  std::vector<std::int64_t> values;
  values.reserve(rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string& cell = rows_[row][index];
    const char* begin = cell.data() + (cell.size() > 1 && cell[0] == '+' && cell[1] != '-');
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size())
      fail(row, name, fmt::format("found '{}', but an integer is required", cell));
    values.push_back(value);
  }
  return values;
}

std::vector<std::string> CsvTable::texts(const std::string& name) {
  const std::size_t index = require(name);
  std::vector<std::string> values;
  values.reserve(rows());
  for (const auto& row : rows_) values.push_back(row[index]);
  return values;
}

void CsvTable::finish(const std::vector<std::string>& ignored) const {
  const auto contains = [](const auto& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  };
  for (const Column& column : columns_) {
    if (contains(asked_, column.name) || contains(asked_, column.header)) continue;
    if (contains(ignored, column.name) || contains(ignored, column.header)) continue;
    // A known name in other letters, or with a unit that is none, is most likely what is meant.
    std::string lower = column.name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    std::string hint;
    for (const auto& known : asked_) {
      if (lower == known || lower.starts_with(known + "_")) hint = fmt::format(" Did you mean '{}'?", known);
      if (lower.starts_with(known + "_") && lower != known)
        hint += fmt::format(" '{}' is no unit that is known here.", column.name.substr(known.size() + 1));
      if (!hint.empty()) break;
    }
    if (hint.empty()) hint = did_you_mean(lower, {asked_.begin(), asked_.end()});
    throw InputError(
        fmt::format("{}: line 1: unknown column '{}'.{} Known here: {} (import.json's 'ignore_columns' "
                    "names those to leave out)",
                    path_.string(), column.header, hint, joined({asked_.begin(), asked_.end()})));
  }
}

}  // namespace tailrun::transfer

#include "transfer_tool/import/csv_table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>

#include "common/error.hpp"

namespace tailrun::transfer {
namespace {

std::vector<std::string> split(std::string line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
  std::vector<std::string> cells;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = line.find(',', start);
    std::string cell = line.substr(start, comma == std::string::npos ? comma : comma - start);
    const std::size_t first = cell.find_first_not_of(" \t\"");
    const std::size_t last = cell.find_last_not_of(" \t\"");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    if (comma == std::string::npos) return cells;
    start = comma + 1;
  }
}

const std::vector<std::pair<std::string, double>>& units() {
  static const std::vector<std::pair<std::string, double>> known = {
      {"_m_s2", 1.0}, {"_m_s", 1.0}, {"_kg_m3", 1.0}, {"_kPa", 1e3}, {"_MPa", 1e6}, {"_Pa", 1.0}, {"_m", 1.0}};
  return known;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& path) : path_(path) {
  std::ifstream stream(path);
  if (!stream) throw InputError(fmt::format("{}: no such file, or it cannot be read", path.string()));
  std::string line;
  if (!std::getline(stream, line)) throw InputError(fmt::format("{}: empty; a header line is required", path.string()));
  header_ = split(line);
  for (std::size_t i = 0; i < header_.size(); ++i) {
    columns_.emplace(header_[i], Column{i, 1.0});
    for (const auto& [suffix, factor] : units())
      if (header_[i].size() > suffix.size() && header_[i].ends_with(suffix)) {
        columns_[header_[i]].to_si = factor;
        columns_.emplace(header_[i].substr(0, header_[i].size() - suffix.size()), Column{i, factor});
        break;
      }
  }
  while (std::getline(stream, line)) {
    auto cells = split(line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() != header_.size())
      throw InputError(fmt::format("{}: line {} has {} cells, but the header has {}", path.string(), rows_.size() + 2,
                                   cells.size(), header_.size()));
    rows_.push_back(std::move(cells));
  }
}

void CsvTable::fail(std::size_t row, const std::string& name, const std::string& message) const {
  throw InputError(fmt::format("{}: line {}, column '{}': {}", path_.string(), row + 2, name, message));
}

const CsvTable::Column* CsvTable::find(const std::string& name) const {
  const auto it = columns_.find(name);
  return it == columns_.end() ? nullptr : &it->second;
}

const CsvTable::Column& CsvTable::require(const std::string& name) const {
  if (const Column* column = find(name)) return *column;
  throw InputError(fmt::format("{}: no column '{}'.{} Found: {}", path_.string(), name, did_you_mean(name, header_),
                               joined(header_)));
}

bool CsvTable::has(const std::string& name) const {
  return find(name) != nullptr;
}

std::vector<double> CsvTable::numbers(const std::string& name) const {
  const Column column = require(name);
  std::vector<double> values;
  values.reserve(rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string& cell = rows_[row][column.index];
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value))
      fail(row, name, fmt::format("found '{}', but a finite number is required", cell));
    values.push_back(value * column.to_si);
  }
  return values;
}

std::vector<double> CsvTable::numbers_or(const std::string& name, double fallback) const {
  return has(name) ? numbers(name) : std::vector<double>(rows(), fallback);
}

std::vector<std::int64_t> CsvTable::integers(const std::string& name) const {
  const Column column = require(name);
  std::vector<std::int64_t> values;
  values.reserve(rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string& cell = rows_[row][column.index];
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size())
      fail(row, name, fmt::format("found '{}', but an integer is required", cell));
    values.push_back(value);
  }
  return values;
}

std::vector<std::string> CsvTable::texts(const std::string& name) const {
  const Column column = require(name);
  std::vector<std::string> values;
  values.reserve(rows());
  for (const auto& row : rows_) values.push_back(row[column.index]);
  return values;
}

}  // namespace tailrun::transfer

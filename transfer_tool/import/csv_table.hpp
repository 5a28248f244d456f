// Comma-separated tables with one header line, whose column names may say their unit: "x_m", "p_kPa", "vx_cm_s",
// "syy [psf]", "p (bar)".
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tailrun::transfer {

// What a column holds; its unit must be one of it.
enum class Quantity { number, length, velocity, acceleration, pressure, strain };

class CsvTable {
 public:
  // Throws InputError: missing file, empty file, rows of unequal length, a column twice. A byte order mark is skipped.
  explicit CsvTable(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::size_t rows() const { return rows_.size(); }
  // A column "name" with or without a unit, converted to SI; without one the values are SI. Asking makes a column
  // known. Throws InputError naming line and column of what is not a number, and units of another quantity.
  bool has(const std::string& name);
  std::vector<double> numbers(const std::string& name, Quantity quantity);
  std::vector<double> numbers_or(const std::string& name, Quantity quantity, double fallback);
  std::vector<std::int64_t> integers(const std::string& name);
  std::vector<std::string> texts(const std::string& name);
  // Throws InputError on the first column that nobody asked for and that `ignored` does not name, with the nearest
  // known one.
  void finish(const std::vector<std::string>& ignored) const;
  std::size_t line_of(std::size_t row) const { return lines_[row]; }
  [[noreturn]] void fail(std::size_t row, const std::string& name, const std::string& message) const;

 private:
  struct Column {
    std::string header, name, unit;  // "vx_cm_s" is "vx" in "cm_s"
  };
  const Column* find(const std::string& name);
  std::size_t require(const std::string& name);
  double factor(const Column& column, Quantity quantity) const;

  std::filesystem::path path_;
  std::vector<Column> columns_;
  std::set<std::string> asked_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> lines_;  // of each row in the file
};

}  // namespace tailrun::transfer

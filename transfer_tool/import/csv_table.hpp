// Comma-separated tables with one header line, whose column names may end in a unit: "x_m", "p_kPa", "vx_m_s".
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tailrun::transfer {

class CsvTable {
 public:
  // Throws InputError: missing file, empty file, rows of unequal length.
  explicit CsvTable(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::size_t rows() const { return rows_.size(); }
  // A column "name" or "name_unit" in SI units: m, m_s, m_s2, Pa, kPa, MPa, 1 and kg_m3 are known. Without a unit in
  // the header the values are taken as they are. Throws InputError naming line and column of what is not a number.
  bool has(const std::string& name) const;
  std::vector<double> numbers(const std::string& name) const;
  std::vector<double> numbers_or(const std::string& name, double fallback) const;
  std::vector<std::int64_t> integers(const std::string& name) const;
  std::vector<std::string> texts(const std::string& name) const;
  [[noreturn]] void fail(std::size_t row, const std::string& name, const std::string& message) const;

 private:
  struct Column {
    std::size_t index;
    double to_si;
  };
  const Column* find(const std::string& name) const;
  const Column& require(const std::string& name) const;

  std::filesystem::path path_;
  std::vector<std::string> header_;
  std::map<std::string, Column> columns_;  // by the header's name and by that name without its unit
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tailrun::transfer

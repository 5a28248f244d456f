// Histories at named points and elements, and the series by which the transfer time is chosen: liquefied depth, pore
// pressure, mesh quality. Comma-separated, SI, one row per interval; written beside its final name and renamed at the
// end.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "fem_stage/model/model.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

// Motion of a rigid base, added to the results (zero for a compliant one).
struct BaseMotion {
  double acceleration = 0.0, velocity = 0.0, displacement = 0.0;
};

// A table of results, row by row, under a temporary name until finish(); an unfinished one is removed. All throw
// ComputationError when it cannot be written.
class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, const std::vector<std::string>& columns);
  ~CsvFile();
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;
  void row(const std::vector<double>& values);
  void finish();
  const std::vector<std::string>& lines() const { return lines_; }  // the rows so far
  void restore(const std::vector<std::string>& lines);

 private:
  void write(std::string line);
  void check() const;
  std::filesystem::path path_, temporary_;
  std::ofstream stream_;
  std::vector<std::string> lines_;
};

class History {
 public:
  History(const Model& model, const std::filesystem::path& folder);
  void record(const State& state, const BaseMotion& base);
  void finish() { file_.finish(); }
  const std::vector<std::string>& lines() const { return file_.lines(); }
  void restore(const std::vector<std::string>& lines) { file_.restore(lines); }

 private:
  const Model& model_;
  std::vector<std::size_t> nodes_, elements_;
  CsvFile file_;
};

struct QualityRow {
  double time, largest_displacement, smallest_jacobian;
  double jacobian_kept;  // 1, least over the elements: scaled Jacobian now over that at the start
  double liquefied_depth, mean_ratio, liquefied_share;
  int inverted;
};

class QualitySeries {
 public:
  QualitySeries(const Model& model, const std::filesystem::path& folder);
  void record(const State& state, const SolverCounts& counts, double wall_seconds);
  void finish() { file_.finish(); }
  const std::vector<QualityRow>& rows() const { return rows_; }
  const std::vector<std::string>& lines() const { return file_.lines(); }
  void restore(std::vector<QualityRow> rows, const std::vector<std::string>& lines) {
    rows_ = std::move(rows);
    file_.restore(lines);
  }

 private:
  const Model& model_;
  std::vector<std::size_t> window_;  // elements of the liquefaction region inside the window
  double window_width_ = 0.0;        // m
  std::vector<double> jacobians_before_;
  std::vector<QualityRow> rows_;
  CsvFile file_;
};

}  // namespace tailrun::fem

// The moving bodies' history: displacement, and the mean force of the material on each since the row before.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "mpm_stage/boundary/moving_bodies.hpp"

namespace tailrun::mpm {

struct BodyRow {
  double time = 0.0;           // s
  std::vector<double> values;  // per body: displacement (m), impulse since the start (N s), Dim of each
};

template <int Dim>
class BodySeries {
 public:
  explicit BodySeries(std::vector<std::string> names) : names_(std::move(names)) {}

  void sample(double time, const std::vector<BodyState<Dim>>& bodies);
  const std::vector<BodyRow>& rows() const { return rows_; }
  void restore(std::vector<BodyRow> rows) { rows_ = std::move(rows); }
  // Mean force (N, per metre in plane strain) on body b between row r - 1 and row r; 0 for the first row.
  std::array<double, Dim> force(std::size_t r, std::size_t b) const;
  // Nothing is written without bodies.
  void write(const std::filesystem::path& path) const;

 private:
  std::vector<std::string> names_;
  std::vector<BodyRow> rows_;
};

}  // namespace tailrun::mpm

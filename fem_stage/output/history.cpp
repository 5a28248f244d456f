#include "fem_stage/output/history.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "common/error.hpp"
#include "common/output_place.hpp"
#include "fem_stage/model/output_places.hpp"
#include "fem_stage/output/state_file.hpp"

namespace tailrun::fem {
namespace {

std::vector<std::string> history_columns(const FemCase& options) {
  std::vector<std::string> columns = {"time_s"};
  for (const auto& point : options.output.points)
    for (const char* field : {"ux_m", "uy_m", "vx_m_s", "vy_m_s", "ax_m_s2", "ay_m_s2", "pore_pressure_Pa"})
      columns.push_back(point.name + "_" + field);
  for (const auto& element : options.output.elements)
    for (const char* field : {"effective_stress_xx_Pa", "effective_stress_yy_Pa", "effective_stress_xy_Pa",
                              "pore_pressure_Pa", "excess_pore_pressure_ratio", "shear_strain"})
      columns.push_back(element.name + "_" + field);
  return columns;
}

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path, const std::vector<std::string>& columns)
    : path_(path), temporary_(temporary_name(path)) {
  require_replaceable(path);
  stream_.open(temporary_);
  for (std::size_t i = 0; i < columns.size(); ++i) stream_ << (i ? "," : "") << columns[i];
  stream_ << '\n';
  check();
}

CsvFile::~CsvFile() {
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
}

void CsvFile::row(const std::vector<double>& values) {
  write(fmt::format("{:.8g}", fmt::join(values, ",")));
}

void CsvFile::restore(const std::vector<std::string>& lines) {
  for (const auto& line : lines) write(line);
}

void CsvFile::write(std::string line) {
  stream_ << line << '\n';
  check();
  lines_.push_back(std::move(line));
}

void CsvFile::finish() {
  stream_.close();  // also writes what is still held back
  check();
  std::filesystem::rename(temporary_, path_);
  temporary_.clear();
}

void CsvFile::check() const {
  if (!stream_) throw ComputationError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

History::History(const Model& model, const std::filesystem::path& folder)
    : model_(model), file_(folder / "history.csv", history_columns(*model.options)) {
  for (const auto& point : model.options->output.points) nodes_.push_back(model.mesh.nearest_node(point.x, point.y));
  for (const auto& element : model.options->output.elements)
    elements_.push_back(model.mesh.nearest_element(element.x, element.y));
}

void History::record(const State& state, const BaseMotion& base) {
  std::vector<double> values = {state.time};
  for (const std::size_t n : nodes_)
    values.insert(values.end(),
                  {state.displacement[2 * n] + base.displacement, state.displacement[2 * n + 1],
                   state.velocity[2 * n] + base.velocity, state.velocity[2 * n + 1],
                   state.acceleration[2 * n] + base.acceleration, state.acceleration[2 * n + 1], state.pressure[n]});
  if (!elements_.empty()) {
    const auto ratio = excess_pore_pressure_ratio(model_, state);
    const auto strain = shear_strain(model_, state);
    for (const std::size_t e : elements_) {
      double pressure = 0.0;
      for (std::size_t a = 0; a < 4; ++a)
        pressure += 0.25 * state.pressure[static_cast<std::size_t>(model_.mesh.quads[4 * e + a])];
      values.insert(values.end(), {state.stress[4 * e], state.stress[4 * e + 1], state.stress[4 * e + 3], pressure,
                                   ratio[e], strain[e]});
    }
  }
  file_.row(values);
}

QualitySeries::QualitySeries(const Model& model, const std::filesystem::path& folder)
    : model_(model),
      jacobians_before_(scaled_jacobians(model.mesh, {})),
      file_(folder / "quality.csv",
            {"time_s", "largest_displacement_m", "smallest_scaled_jacobian", "least_jacobian_kept", "inverted_elements",
             "liquefied_depth_m", "mean_excess_pore_pressure_ratio", "liquefied_share", "steps", "iterations",
             "factorisations", "material_substeps", "wall_s"}) {
  const auto& output = model.options->output;
  window_ = liquefaction_elements(model.mesh, output);
  if (!window_.empty()) window_width_ = output.liquefaction_window[1] - output.liquefaction_window[0];
}

void QualitySeries::record(const State& state, const SolverCounts& counts, double wall_seconds) {
  QualityRow row{};
  row.time = state.time;
  for (std::size_t n = 0; n < model_.nodes(); ++n)
    row.largest_displacement =
        std::max(row.largest_displacement, std::hypot(state.displacement[2 * n], state.displacement[2 * n + 1]));
  const auto jacobians = scaled_jacobians(model_.mesh, state.displacement);
  row.smallest_jacobian = *std::min_element(jacobians.begin(), jacobians.end());
  row.jacobian_kept = 1.0;
  for (std::size_t e = 0; e < jacobians.size(); ++e)
    row.jacobian_kept = std::min(row.jacobian_kept, jacobians[e] / jacobians_before_[e]);
  row.inverted = static_cast<int>(std::count_if(jacobians.begin(), jacobians.end(), [](double j) { return j <= 0.0; }));
  if (!window_.empty()) {
    const auto ratio = excess_pore_pressure_ratio(model_, state);
    double area = 0.0, liquefied = 0.0, weighted = 0.0;
    for (const std::size_t e : window_) {
      const double a = model_.elements.volume[e] / model_.thickness[e];
      area += a;
      weighted += a * ratio[e];
      if (ratio[e] >= model_.options->output.liquefaction_threshold) liquefied += a;
    }
    row.liquefied_depth = liquefied / window_width_;  // thickness of liquefied soil, mean over the window
    row.mean_ratio = weighted / area;
    row.liquefied_share = liquefied / area;
  }
  rows_.push_back(row);
  file_.row({row.time, row.largest_displacement, row.smallest_jacobian, row.jacobian_kept,
             static_cast<double>(row.inverted), row.liquefied_depth, row.mean_ratio, row.liquefied_share,
             static_cast<double>(counts.steps), static_cast<double>(counts.iterations),
             static_cast<double>(counts.factorisations), static_cast<double>(counts.material_substeps), wall_seconds});
}

}  // namespace tailrun::fem

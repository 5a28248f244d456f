#include "mpm_stage/output/body_series.hpp"

#include <fmt/core.h>

#include "common/application.hpp"

namespace tailrun::mpm {

template <int Dim>
void BodySeries<Dim>::sample(double time, const std::vector<BodyState<Dim>>& bodies) {
  if (bodies.empty()) return;
  BodyRow row;
  row.time = time;
  for (const BodyState<Dim>& b : bodies) {
    row.values.insert(row.values.end(), b.displacement.begin(), b.displacement.end());
    row.values.insert(row.values.end(), b.impulse.begin(), b.impulse.end());
  }
  rows_.push_back(std::move(row));
}

template <int Dim>
std::array<double, Dim> BodySeries<Dim>::force(std::size_t r, std::size_t b) const {
  std::array<double, Dim> f{};
  if (r == 0 || !(rows_[r].time > rows_[r - 1].time)) return f;
  for (std::size_t d = 0; d < Dim; ++d) {
    const std::size_t k = 2 * Dim * b + Dim + d;
    f[d] = (rows_[r].values[k] - rows_[r - 1].values[k]) / (rows_[r].time - rows_[r - 1].time);
  }
  return f;
}

template <int Dim>
void BodySeries<Dim>::write(const std::filesystem::path& path) const {
  if (names_.empty()) return;
  const char axes[] = "xyz";
  std::string text = "time_s";
  for (const std::string& name : names_) {
    for (int d = 0; d < Dim; ++d) text += fmt::format(",{}_displacement_{}_m", name, axes[d]);
    for (int d = 0; d < Dim; ++d) text += fmt::format(",{}_force_{}_N", name, axes[d]);
  }
  text += "\n";
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    text += fmt::format("{:.9g}", rows_[r].time);
    for (std::size_t b = 0; b < names_.size(); ++b) {
      for (std::size_t d = 0; d < Dim; ++d) text += fmt::format(",{:.9g}", rows_[r].values[2 * Dim * b + d]);
      for (const double f : force(r, b)) text += fmt::format(",{:.9g}", f);
    }
    text += "\n";
  }
  write_text_file(path.string(), text);
}

template class BodySeries<2>;
template class BodySeries<3>;

}  // namespace tailrun::mpm

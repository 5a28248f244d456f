#include "mpm_stage/output/section_series.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "common/application.hpp"
#include "mpm_stage/output/runout_measures.hpp"

namespace tailrun::mpm {

SectionSeries::SectionSeries(const Scene& scene)
    : sections_(scene.output.sections),
      moving_(moving_materials(scene)),
      start_(sections_.empty() ? std::vector<double>{} : scene.particles.position),
      start_volume_(sections_.empty() ? std::vector<double>{} : scene.particles.volume),
      behind_mass_(sections_.size(), 0.0),
      behind_volume_(sections_.size(), 0.0),
      dimension_(scene.dimension),
      axis_(scene.output.front_axis),
      sign_(scene.output.front_sign),
      cell_(scene.cell_size),
      flow_distance_(scene.output.flow_distance) {
  const ParticleSet& set = scene.particles;
  for (std::size_t p = 0; p < set.count(); ++p) {
    if (!moving_[static_cast<std::size_t>(set.material_id[p])]) continue;
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      if (sign_ * (set.position[3 * p + static_cast<std::size_t>(axis_)] - sections_[s].at) >= 0.0) continue;
      behind_mass_[s] += set.mass[p];
      behind_volume_[s] += set.volume[p];
    }
  }
}

template <int Dim>
void SectionSeries::sample(double time, const Particles<Dim>& P) {
  if (!any()) return;
  SectionRow row;
  row.time = time;
  row.of.resize(sections_.size());
  for (std::size_t s = 0; s < sections_.size(); ++s) {
    row.of[s].mass = behind_mass_[s];
    row.of[s].volume = behind_volume_[s];
  }
  for (std::size_t p = 0; p < P.count(); ++p) {
    if (!moving_[static_cast<std::size_t>(P.material[p])]) continue;
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      SectionState& state = row.of[s];
      const double ahead = sign_ * (P.position[axis_][p] - sections_[s].at);
      if (ahead < 0.0) {
        state.mass -= P.mass[p];
        state.volume -= start_volume_[static_cast<std::size_t>(P.identity[p])];
      }
      if (std::fabs(ahead) > cell_) continue;
      if (!has_flowed<Dim>(P, p, start_, flow_distance_)) continue;
      state.area += P.volume[p] / (2.0 * cell_);
      state.discharge += sign_ * P.velocity[axis_][p] * P.volume[p] / (2.0 * cell_);
    }
  }
  rows_.push_back(std::move(row));
}

void SectionSeries::write(const std::filesystem::path& path) const {
  if (!any()) return;
  std::string text = "time_s";
  for (const FlowSection& section : sections_)
    text += fmt::format(
        fmt::runtime(dimension_ == 2
                         ? ",{0}_discharge_m2_s,{0}_depth_m,{0}_speed_m_s,{0}_passed_volume_m2,{0}_passed_mass_kg_m"
                         : ",{0}_discharge_m3_s,{0}_area_m2,{0}_speed_m_s,{0}_passed_volume_m3,{0}_passed_mass_kg"),
        section.name);
  text += "\n";
  for (const SectionRow& row : rows_) {
    text += fmt::format("{:.9g}", row.time);
    for (const SectionState& x : row.of)
      text += fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", x.discharge, x.area, x.speed(), x.volume, x.mass);
    text += "\n";
  }
  write_text_file(path.string(), text);
}

nlohmann::ordered_json SectionSeries::summary() const {
  const bool plane = dimension_ == 2;
  auto all = nlohmann::ordered_json::array();
  for (std::size_t s = 0; s < sections_.size() && !rows_.empty(); ++s) {
    const SectionState& last = rows_.back().of[s];
    double most = 0.0, at = rows_.front().time, largest = 0.0;
    for (const SectionRow& r : rows_) {
      largest = std::max(largest, r.of[s].area);
      if (r.of[s].discharge <= most) continue;
      most = r.of[s].discharge;
      at = r.time;
    }
    all.push_back({{"name", sections_[s].name},
                   {"at_m", sections_[s].at},
                   {plane ? "passed_volume_m2" : "passed_volume_m3", last.volume},
                   {plane ? "passed_mass_kg_m" : "passed_mass_kg", last.mass},
                   {plane ? "largest_discharge_m2_s" : "largest_discharge_m3_s", most},
                   {"time_of_largest_discharge_s", at},
                   {plane ? "largest_depth_m" : "largest_area_m2", largest}});
  }
  return all;
}

template void SectionSeries::sample<2>(double, const Particles<2>&);
template void SectionSeries::sample<3>(double, const Particles<3>&);

}  // namespace tailrun::mpm

// What passes vertical sections across the flow: hydrographs for those who carry on with the flow downstream.
//
// Of moving soil, with positions along the flow's axis. At each row of the series, for the section at s and a band of
// a cell on either side of it, width B = 2 h:
//   discharge  Q = sum V_p v_p / B, v_p the speed in the flow's direction, over soil in the band that has flowed
//   area       A = sum V_p / B, over the same: the flow's depth in plane strain
//   passed     mass that was behind the section at the start less that which is there now, and its volume as at the
//              start: soil that swells behind the section passes nothing
#pragma once

#include <filesystem>
#include <vector>

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

struct SectionState {
  double mass = 0.0, volume = 0.0;     // kg, m3 (per metre in plane strain): passed since the start
  double area = 0.0, discharge = 0.0;  // m2, m3/s (m, m2/s in plane strain)
  double speed() const { return area > 0.0 ? discharge / area : 0.0; }  // m/s
};

struct SectionRow {
  double time = 0.0;  // s
  std::vector<SectionState> of;
};

class SectionSeries {
 public:
  explicit SectionSeries(const Scene& scene);

  bool any() const { return !sections_.empty(); }
  template <int Dim>
  void sample(double time, const Particles<Dim>& particles);
  const std::vector<SectionRow>& rows() const { return rows_; }
  void restore(std::vector<SectionRow> rows) { rows_ = std::move(rows); }

  // Nothing is written without sections.
  void write(const std::filesystem::path& path) const;
  // For summary.json: what has passed each, and the largest discharge and depth with their times.
  nlohmann::ordered_json summary() const;

 private:
  std::vector<FlowSection> sections_;
  std::vector<bool> moving_;                         // by material
  std::vector<double> start_, start_volume_;         // m, (n, 3), and m3: of the particles, by identity
  std::vector<double> behind_mass_, behind_volume_;  // kg, m3: behind each section at the start
  int dimension_, axis_;
  double sign_, cell_, flow_distance_;
  std::vector<SectionRow> rows_;
};

}  // namespace tailrun::mpm

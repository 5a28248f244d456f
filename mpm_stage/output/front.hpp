// Where the mass has got to: the front, the runout, the top, and points that are followed; and whether it has come to
// rest. What runout and ground are is said in runout_measures.hpp.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "mpm_stage/output/runout_measures.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

struct FrontRow {
  double time = 0.0;                      // s
  double front = 0.0;                     // m, outermost moving particle
  double robust_front = 0.0;              // m, ahead of which only 1 - quantile of the moving mass lies
  double flow_front = 0.0;                // m, the same for the mass that has flowed (OutputOptions::flow_distance)
  double flow_body = 0.0;                 // m, the same with OutputOptions::body_quantile
  double coherent_front = 0.0;            // m, outermost of what has flowed without a gap behind it
  double ground = 0.0;                    // m, highest ground over the dam's footprint
  double flowed_mass = 0.0;               // kg
  double top = 0.0;                       // m, highest moving particle
  double centre_x = 0.0, centre_y = 0.0;  // m, of the moving mass
  double rms_speed = 0.0;                 // m/s, of the moving mass
  double maximum_speed = 0.0;             // m/s
  std::vector<double> points;             // m, x and y of the followed points
};

template <int Dim>
class FrontSeries {
 public:
  explicit FrontSeries(const Scene& scene);
  const FrontRow& sample(double time, const Particles<Dim>& P);
  // Both thresholds of the criterion have held for its whole duration.
  bool at_rest(const RestCriterion& rest) const;
  // For that duration the kinetic energy has been at most energy_share of the largest so far, and the flow's front at
  // most as fast as its root of the fastest: what goes on moves the runout by little more (AvaFrame's com1DFA ends a
  // run at 1 % of the energy, too).
  bool flow_is_over(const RestCriterion& rest) const;
  // m/s, of the flow's front over the last `duration` (s) of the rows, or as long as there has been one; NaN without.
  double front_speed(double duration) const;
  const std::vector<FrontRow>& rows() const { return rows_; }
  double toe() const { return toe_; }                                    // m, before the motion
  const std::array<double, 2>& footprint() const { return footprint_; }  // m, along the flow, before the motion
  double ground_before() const { return ground_before_; }                // m, over it, before the motion
  // m, from the toe to `front` of a row (a position), along the flow.
  double runout(double front) const { return output_.front_sign * (front - toe_); }
  // m, the one number: to the flow's front, but never beyond both the soil that hangs together and the flow's body,
  // so that a few drops which a slope carries off do not make it.
  double runout(const FrontRow& row) const;
  void restore(std::vector<FrontRow> rows);
  void write(const std::filesystem::path& path) const;

 private:
  void note_fastest();

  std::vector<bool> moving_;  // by material
  OutputOptions output_;
  std::vector<std::int32_t> followed_;  // identities
  std::vector<FrontRow> rows_;
  double rest_duration_;                                  // s
  double largest_rms_speed_ = 0.0, fastest_front_ = 0.0;  // m/s, so far; of the front over rest_duration_
  std::vector<double> start_;                             // m, (particles, 3), by identity
  Ahead scratch_, flowed_;
  double cell_size_, toe_ = 0.0, ground_before_ = 0.0;
  std::array<double, 2> footprint_{};
  std::optional<GroundOverFootprint> ground_;
};

}  // namespace tailrun::mpm

#include "mpm_stage/output/front.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/application.hpp"
#include "mpm_stage/output/csv_cell.hpp"

namespace tailrun::mpm {

template <int Dim>
FrontSeries<Dim>::FrontSeries(const Scene& scene)
    : moving_(moving_materials(scene)),
      output_(scene.output),
      rest_duration_(scene.rest.duration),
      start_(scene.particles.position),
      cell_size_(scene.cell_size) {
  const ParticleSet& set = scene.particles;
  const std::vector<double> before = positions_before(set);
  std::vector<bool> moves(set.count());
  for (std::size_t p = 0; p < set.count(); ++p) moves[p] = moving_[static_cast<std::size_t>(set.material_id[p])];
  toe_ = output_.toe ? *output_.toe : outermost(before, moves, output_.front_axis, output_.front_sign);
  footprint_ = output_.footprint ? *output_.footprint
                                 : footprint_of(before, moves, output_.front_axis, output_.front_sign, toe_);
  ground_.emplace(Dim, output_.front_axis, footprint_, cell_size_);
  ground_before_ =
      (*ground_)(set.count(), [&before](std::size_t p, int d) { return before[3 * p + static_cast<std::size_t>(d)]; });
  // The crest, unless points are named: the highest moving particle, and of those at the same height the outermost.
  if (output_.points.empty()) {
    double top = -std::numeric_limits<double>::infinity(), out = top;
    TrackedPoint crest{"crest", {0.0, 0.0}};
    for (std::size_t p = 0; p < set.count(); ++p) {
      if (!moving_[static_cast<std::size_t>(set.material_id[p])]) continue;
      const double x = set.position[3 * p], y = set.position[3 * p + 1], ahead = output_.front_sign * x;
      if (y > top + 1e-9 || (y > top - 1e-9 && ahead > out)) {
        top = std::max(top, y);
        out = ahead;
        crest.position = {x, y};
      }
    }
    output_.points.push_back(crest);
  }
  for (const auto& point : output_.points) {
    double least = std::numeric_limits<double>::infinity();
    std::int32_t nearest = 0;
    for (std::size_t p = 0; p < set.count(); ++p) {
      if (!moving_[static_cast<std::size_t>(set.material_id[p])]) continue;
      const double d = std::hypot(set.position[3 * p] - point.position[0], set.position[3 * p + 1] - point.position[1]);
      if (d < least) {
        least = d;
        nearest = static_cast<std::int32_t>(p);
      }
    }
    followed_.push_back(nearest);
  }
}

template <int Dim>
const FrontRow& FrontSeries<Dim>::sample(double time, const Particles<Dim>& P) {
  FrontRow row;
  row.time = time;
  row.points.assign(2 * followed_.size(), std::nan(""));
  row.top = -std::numeric_limits<double>::infinity();
  scratch_.clear();
  flowed_.clear();
  double mass = 0.0, energy = 0.0, fastest = 0.0;
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (std::size_t k = 0; k < followed_.size(); ++k)
      if (P.identity[p] == followed_[k]) {
        row.points[2 * k] = P.position[0][p];
        row.points[2 * k + 1] = P.position[1][p];
      }
    if (!moving_[static_cast<std::size_t>(P.material[p])]) continue;
    double v2 = 0.0;
    for (int d = 0; d < Dim; ++d) v2 += P.velocity[d][p] * P.velocity[d][p];
    mass += P.mass[p];
    energy += P.mass[p] * v2;
    fastest = std::max(fastest, v2);
    row.centre_x += P.mass[p] * P.position[0][p];
    row.centre_y += P.mass[p] * P.position[1][p];
    row.top = std::max(row.top, P.position[1][p]);
    scratch_.emplace_back(output_.front_sign * P.position[output_.front_axis][p], P.mass[p]);
    if (has_flowed<Dim>(P, p, start_, output_.flow_distance)) {
      flowed_.push_back(scratch_.back());
      row.flowed_mass += P.mass[p];
    }
  }
  put_foremost_first(scratch_, output_.front_quantile);
  put_foremost_first(flowed_);
  row.flow_front = output_.front_sign * quantile_front(flowed_, output_.front_quantile);
  row.flow_body = output_.front_sign * quantile_front(flowed_, output_.body_quantile);
  row.coherent_front = output_.front_sign * coherent_front(scratch_, flowed_, coherent_gap * cell_size_);
  row.ground = (*ground_)(P.count(), [&P](std::size_t p, int d) { return P.position[d][p]; });
  if (!scratch_.empty()) {
    row.robust_front = output_.front_sign * quantile_front(scratch_, output_.front_quantile);
    row.front = output_.front_sign * scratch_.front().first;
    row.centre_x /= mass;
    row.centre_y /= mass;
    row.rms_speed = std::sqrt(energy / mass);
    row.maximum_speed = std::sqrt(fastest);
  }
  rows_.push_back(std::move(row));
  note_fastest();
  return rows_.back();
}

template <int Dim>
void FrontSeries<Dim>::note_fastest() {
  largest_rms_speed_ = std::max(largest_rms_speed_, rows_.back().rms_speed);
  if (const double speed = front_speed(rest_duration_); speed > fastest_front_) fastest_front_ = speed;
}

template <int Dim>
void FrontSeries<Dim>::restore(std::vector<FrontRow> rows) {
  rows_.clear();
  for (FrontRow& row : rows) {
    rows_.push_back(std::move(row));
    note_fastest();
  }
}

template <int Dim>
double FrontSeries<Dim>::runout(const FrontRow& row) const {
  return std::min(runout(row.flow_front), std::max(runout(row.coherent_front), runout(row.flow_body)));
}

template <int Dim>
bool FrontSeries<Dim>::at_rest(const RestCriterion& rest) const {
  if (!rest.active || rows_.empty()) return false;
  const FrontRow& last = rows_.back();
  if (last.time - rows_.front().time < rest.duration) return false;
  for (auto row = rows_.rbegin(); row != rows_.rend(); ++row) {
    if (row->rms_speed > rest.speed) return false;
    if (last.time - row->time >= rest.duration * (1.0 - 1e-9))
      return std::fabs(last.robust_front - row->robust_front) <= rest.speed * (last.time - row->time);
  }
  return false;
}

template <int Dim>
bool FrontSeries<Dim>::flow_is_over(const RestCriterion& rest) const {
  if (!rest.active || !(rest.energy_share > 0.0) || rows_.empty()) return false;
  const double slow = std::sqrt(rest.energy_share);  // of speeds
  if (front_speed(rest.duration) > slow * fastest_front_) return false;
  for (auto row = rows_.rbegin(); row != rows_.rend(); ++row) {
    if (row->rms_speed > slow * largest_rms_speed_) return false;
    if (rows_.back().time - row->time >= rest.duration * (1.0 - 1e-9)) return true;
  }
  return false;
}

template <int Dim>
double FrontSeries<Dim>::front_speed(double duration) const {
  double speed = std::nan("");
  for (auto row = rows_.rbegin(); row != rows_.rend() && std::isfinite(row->flow_front); ++row) {
    const double since = rows_.back().time - row->time;
    if (since > 0.0) speed = output_.front_sign * (rows_.back().flow_front - row->flow_front) / since;
    if (since >= duration * (1.0 - 1e-9)) break;
  }
  return speed;
}

template <int Dim>
void FrontSeries<Dim>::write(const std::filesystem::path& path) const {
  std::string text =
      "time_s,front_m,robust_front_m,top_m,centre_x_m,centre_y_m,rms_speed_m_s,maximum_speed_m_s,flow_front_m,flowed_"
      "mass_kg,flow_body_m,coherent_front_m,runout_m,ground_m";
  for (const auto& p : output_.points) text += fmt::format(",{0}_x_m,{0}_y_m", p.name);
  text += "\n";
  for (const auto& r : rows_) {
    text += fmt::format("{:.9g}", r.time);
    for (const double x : {r.front, r.robust_front, r.top, r.centre_x, r.centre_y, r.rms_speed, r.maximum_speed,
                           r.flow_front, r.flowed_mass, r.flow_body, r.coherent_front, runout(r), r.ground})
      text += csv_cell(x, 9);
    for (const double x : r.points) text += csv_cell(x, 9);
    text += "\n";
  }
  write_text_file(path.string(), text);
}

template class FrontSeries<2>;
template class FrontSeries<3>;

}  // namespace tailrun::mpm

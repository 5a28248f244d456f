#include "mpm_stage/output/runout_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tailrun::mpm {

std::vector<bool> moving_materials(const Scene& scene) {
  std::vector<bool> moving;
  bool any = false;
  for (const auto& m : scene.materials) {
    moving.push_back(m.law->moves);
    any = any || moving.back();
  }
  if (!any) moving.assign(moving.size(), true);
  return moving;
}

std::vector<double> positions_before(const ParticleSet& set) {
  std::vector<double> before = set.position;
  if (!set.displacement.empty())
    for (std::size_t i = 0; i < before.size(); ++i) before[i] -= set.displacement[i];
  return before;
}

double outermost(const std::vector<double>& positions, const std::vector<bool>& moving, int axis, double sign) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < moving.size(); ++p)
    if (moving[p]) most = std::max(most, sign * positions[3 * p + static_cast<std::size_t>(axis)]);
  return sign * most;
}

std::array<double, 2> footprint_of(const std::vector<double>& positions, const std::vector<bool>& moving, int axis,
                                   double sign, double toe) {
  double top = -std::numeric_limits<double>::infinity(), out = top;
  for (std::size_t p = 0; p < moving.size(); ++p) {
    if (!moving[p]) continue;
    const double y = positions[3 * p + 1], ahead = sign * positions[3 * p + static_cast<std::size_t>(axis)];
    if (y > top + 1e-9 || (y > top - 1e-9 && ahead > out)) {
      top = std::max(top, y);
      out = ahead;
    }
  }
  return {std::min(sign * out, toe), std::max(sign * out, toe)};
}

void put_foremost_first(Ahead& particles, double quantile) {
  const auto ahead = [](const auto& a, const auto& b) { return a.first > b.first; };
  double mass = 0.0, leading = 0.0;
  for (const auto& particle : particles) mass += particle.second;
  const double count = static_cast<double>(particles.size());
  const auto some = static_cast<std::ptrdiff_t>(std::min(count, 8.0 + 2.0 * (1.0 - quantile) * count));
  const auto end = particles.begin() + some;
  if (end == particles.end()) return std::sort(particles.begin(), end, ahead);
  std::partial_sort(particles.begin(), end, particles.end(), ahead);
  for (auto particle = particles.begin(); particle != end; ++particle) leading += particle->second;
  if (leading < (1.0 - quantile) * mass) std::sort(end, particles.end(), ahead);
}

double quantile_front(const Ahead& particles, double quantile) {
  if (particles.empty()) return std::nan("");
  double mass = 0.0;
  for (const auto& particle : particles) mass += particle.second;
  double ahead = 0.0;
  std::size_t k = 0;
  while (k + 1 < particles.size() && ahead + particles[k].second < (1.0 - quantile) * mass)
    ahead += particles[k++].second;
  return particles[k].first;
}

double coherent_front(const Ahead& all, const Ahead& flowed, double gap) {
  if (flowed.empty()) return std::nan("");
  const double middle = quantile_front(flowed, 0.5);
  // Columns as wide as the gap: within one nothing can be farther apart, between two their ends tell.
  // Without a gap n particles reach no farther than n columns; one thrown far out needs no columns up to it.
  const std::size_t columns = all.size() + 1;
  struct Column {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  };
  std::vector<Column> ends(columns);
  for (const auto& [x, mass] : all) {
    if (x < middle || (x - middle) / gap >= static_cast<double>(columns)) continue;
    Column& column = ends[static_cast<std::size_t>((x - middle) / gap)];
    column.low = std::min(column.low, x);
    column.high = std::max(column.high, x);
  }
  double reach = middle;
  for (const Column& column : ends) {
    if (column.high < column.low) continue;
    if (column.low - reach > gap) break;
    reach = column.high;
  }
  double front = middle;
  for (const auto& particle : flowed)
    if (particle.first <= reach) front = std::max(front, particle.first);
  return front;
}

std::int64_t GroundOverFootprint::cell_of(double x) const {
  return static_cast<std::int64_t>(std::floor(x / cell_));
}

double GroundOverFootprint::highest() {
  if (heights_.empty()) return std::nan("");
  std::sort(heights_.begin(), heights_.end(), [](const Height& a, const Height& b) {
    return std::tie(a.strip, a.column, a.y) < std::tie(b.strip, b.column, b.y);
  });
  double lowest_strip = std::numeric_limits<double>::infinity(), of_strip = -lowest_strip;
  double ground = heights_.front().y;
  bool coherent = true;
  for (std::size_t k = 0; k < heights_.size(); ++k) {
    const Height& h = heights_[k];
    const bool same_strip = k > 0 && heights_[k - 1].strip == h.strip;
    if (!same_strip || heights_[k - 1].column != h.column) {
      coherent = true;
      ground = h.y;
    }
    if (k > 0 && !same_strip) {
      lowest_strip = std::min(lowest_strip, of_strip);
      of_strip = -std::numeric_limits<double>::infinity();
    }
    coherent = coherent && h.y - ground <= cell_;
    if (coherent) ground = h.y;
    of_strip = std::max(of_strip, ground);
  }
  return std::min(lowest_strip, of_strip);
}

}  // namespace tailrun::mpm

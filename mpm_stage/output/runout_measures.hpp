// How far soil has run and how much height the dam has lost, each defined once: for series, summary, report, pictures.
//
//   toe       where the dam ended before the motion: the outermost moving soil, or what the case says ("output/toe")
//   runout    from the toe along the flow's direction to a front of the soil that has flowed; below zero the front
//             stands short of the toe
//   ground    the highest coherent ground over the dam's footprint; freeboard lost is its fall. Single particles that
//             travel, or hang in the air, are not ground.
// Positions are those of particles' centres.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

// By material, whether it counts: all that are not linear elastic, unless everything is.
std::vector<bool> moving_materials(const Scene& scene);

// Whether particle p is farther than `distance` (m) from where it started; `start` (n, 3), m, by identity.
template <int Dim>
bool has_flowed(const Particles<Dim>& P, std::size_t p, const std::vector<double>& start, double distance) {
  double moved2 = 0.0;
  for (int d = 0; d < Dim; ++d) {
    const double u =
        P.position[d][p] - start[3 * static_cast<std::size_t>(P.identity[p]) + static_cast<std::size_t>(d)];
    moved2 += u * u;
  }
  return moved2 > distance * distance;
}

// Positions before the motion began: of particles that carry a displacement, less that; (n, 3), m.
std::vector<double> positions_before(const ParticleSet& set);

// m, along `axis`: of the particles with moving[p] the one farthest in the direction `sign`.
double outermost(const std::vector<double>& positions, const std::vector<bool>& moving, int axis, double sign);

// From the highest moving particle (the outermost of those as high) to the toe, as low and high along the flow.
std::array<double, 2> footprint_of(const std::vector<double>& positions, const std::vector<bool>& moving, int axis,
                                   double sign, double toe);

// Cells: particles up to two cells apart always share a node of quadratic splines, so that one body is what they are.
constexpr double coherent_gap = 2.0;

// A particle ahead of others: its coordinate in the direction of the flow (m, larger is farther) and its mass (kg).
using Ahead = std::vector<std::pair<double, double>>;

// As far back as a `quantile` of the mass needs; all of them with 0.
void put_foremost_first(Ahead& particles, double quantile = 0.0);

// m: the coordinate ahead of which only 1 - quantile of the particles' mass lies. Foremost first. NaN without
// particles.
double quantile_front(const Ahead& particles, double quantile);

// m: the outermost of `flowed` (foremost first) that is reached from the middle of their mass outwards without a gap of
// more than `gap` (m) between particles of `all`. NaN when none has flowed.
double coherent_front(const Ahead& all, const Ahead& flowed, double gap);

// m: the highest ground over footprint[0..1] along `axis`. In each column, a cell wide, the ground reaches up from the
// lowest particle as far as there is no gap of more than a cell; in 3-D the lowest of the strips along the flow counts,
// for there the water would go over. `position(p, d)` is coordinate d of particle p. NaN without particles there, or if
// the flow is vertical.
class GroundOverFootprint {
 public:
  GroundOverFootprint(int dimension, int axis, std::array<double, 2> footprint, double cell_size)
      : dimension_(dimension), axis_(axis), footprint_(footprint), cell_(cell_size) {}

  template <class Position>
  double operator()(std::size_t count, Position position) {
    heights_.clear();
    if (axis_ == 1) return highest();
    const int lateral = axis_ == 0 ? 2 : 0;
    for (std::size_t p = 0; p < count; ++p) {
      const double along = position(p, axis_);
      if (along < footprint_[0] || along > footprint_[1]) continue;
      const double across = dimension_ == 3 ? position(p, lateral) : 0.0;
      heights_.push_back({cell_of(across), cell_of(along), position(p, 1)});
    }
    return highest();
  }

 private:
  struct Height {
    std::int64_t strip, column;
    double y;
  };
  std::int64_t cell_of(double x) const;
  double highest();

  int dimension_, axis_;
  std::array<double, 2> footprint_;
  double cell_;
  std::vector<Height> heights_;
};

}  // namespace tailrun::mpm

// Where the surface between the material of two velocity fields lies, told from what a node sees of each, as if they
// were half-spaces that meet in a plane. The node's weight along a line through it is that of the shape function; how
// it is divided by the plane says how far off the plane is, and how far apart the centres of both parts lie. Material
// in a thin layer lies nearer, across a gap it lies farther; so what the centres are farther apart is, at most, a gap.
#pragma once

#include <algorithm>
#include <array>

namespace tailrun::mpm {

// All lengths in cells, by the share of the node's weight on one side of the plane.
template <class Shape>
class HalfSpaces {
 public:
  HalfSpaces() {
    constexpr int pieces = 4000;
    const double reach = 0.5 * (Shape::support + 1);
    const auto position = [&](int k) { return reach * (2.0 * (k + 0.5) / pieces - 1.0); };
    double total = 0.0, moment = 0.0;
    for (int k = 0; k < pieces; ++k) {
      total += weight(position(k));
      moment += weight(position(k)) * position(k);
    }
    apart_.fill(reach);
    offset_.front() = -reach;
    offset_.back() = reach;
    slice_.fill(0.0);
    double below = 0.0, moment_below = 0.0;
    std::size_t next = 1;
    for (int k = 0; k < pieces; ++k) {
      below += weight(position(k));
      moment_below += weight(position(k)) * position(k);
      for (; next < entries - 1 && below / total >= static_cast<double>(next) / (entries - 1); ++next) {
        apart_[next] = (moment - moment_below) / (total - below) - moment_below / below;
        offset_[next] = position(k);
        slice_[next] = weight(position(k));
      }
    }
  }

  double centres_apart(double share) const { return at(apart_, share); }
  // Of the plane, from the node towards the outside of the half-space that has this share.
  double offset(double share) const { return at(offset_, share); }
  // Weight of the plane itself: the part of it that is the node's, per cell of it.
  double slice(double share) const { return at(slice_, share); }

 private:
  static constexpr std::size_t entries = 129;
  using Table = std::array<double, entries>;

  static double at(const Table& table, double share) {
    const double x = std::clamp(share, 0.0, 1.0) * (entries - 1);
    const auto k = std::min(static_cast<std::size_t>(x), entries - 2);
    return table[k] + (x - static_cast<double>(k)) * (table[k + 1] - table[k]);
  }
  // Of a particle at `x` at the node at 0.
  static double weight(double x) {
    constexpr int S = Shape::support;
    double w[S], d[S], m[S];
    const int first = Shape::evaluate(x + 8.0, w, d, m);
    return first <= 8 && 8 < first + S ? w[8 - first] : 0.0;
  }

  Table apart_{}, offset_{}, slice_{};
};

}  // namespace tailrun::mpm

// The part of the ground's surface that each node of a block stands for, by its function there; all nodes together make
// the whole ground.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mpm_stage/boundary/terrain.hpp"
#include "mpm_stage/grid/shape_functions.hpp"

namespace tailrun::mpm {

// The B x B nodes from (x0, y0) on, x fastest, with weights of quadratic B-splines whatever the scene's shape
// functions.
template <int B, int Bins>
class GroundSurface {
 public:
  GroundSurface(const Terrain& terrain, double x0, double y0, double h) : h_(h) {
    for (const auto& line : terrain.lines())
      for (std::size_t s = 0; s < line.size(); ++s) share(line[s], x0, y0, s == 0, s + 1 == line.size());
  }

  // m, of the ground that is node's own; per metre in the third direction in 3-D
  double operator[](int node) const { return length_[node]; }
  // The same, of it what lies in each of Bins equal parts of the three cells around the node along x or y (axis 1).
  const std::array<float, Bins>& parts(int node, int axis) const { return parts_[axis][node]; }

 private:
  static constexpr int margin = 3;  // nodes around the block, so that coordinates are positive
  static constexpr double pieces_per_cell = 16.0;
  static constexpr double low = -1.5, high = B + 0.5;  // cells from (x0, y0), within reach of the block's nodes

  static std::size_t bin(double cells) {
    return static_cast<std::size_t>(std::clamp((cells + 1.5) * (Bins / 3.0), 0.0, Bins - 1.0));
  }

  // action(node, weight, x, y from the node) for the block's nodes around (x, y), all in cells from (x0, y0).
  template <class Action>
  static void around(double x, double y, Action action) {
    double wx[3], wy[3], unused[3], moment[3];
    const int i0 = QuadraticShape::evaluate(x + margin, wx, unused, moment);
    const int j0 = QuadraticShape::evaluate(y + margin, wy, unused, moment);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int I = i0 + i - margin, J = j0 + j - margin;
        if (I >= 0 && I < B && J >= 0 && J < B) action(J * B + I, wx[i] * wy[j], x - I, y - J);
      }
  }

  // A segment is cut into short pieces, and the nodes around each share it by their weights. The first and the last
  // segment of a line go on without end.
  void share(const Terrain::Segment& segment, double x0, double y0, bool first, bool last) {
    const double ax = (segment.a[0] - x0) / h_, ay = (segment.a[1] - y0) / h_;
    const double tx = (segment.b[0] - segment.a[0]) / h_, ty = (segment.b[1] - segment.a[1]) / h_;
    const double cells = std::hypot(tx, ty), pieces = std::ceil(cells * pieces_per_cell);
    double from = first ? -1e9 : 0.0, to = last ? 1e9 : 1.0;  // share of the segment that crosses the block's square
    for (const auto& [a, t] : {std::pair{ax, tx}, std::pair{ay, ty}}) {
      const double one = (low - a) / t, other = (high - a) / t;
      if (t != 0.0) {
        from = std::max(from, std::min(one, other));
        to = std::min(to, std::max(one, other));
      } else if (a < low || a > high) {
        to = from;
      }
    }
    for (double k = std::floor(from * pieces); from < to && k < to * pieces; ++k) {
      const double at = (k + 0.5) / pieces;
      if (at < from || at >= to) continue;
      around(ax + at * tx, ay + at * ty, [&](int n, double w, double x, double y) {
        const double length = w * cells / pieces * h_;
        length_[n] += length;
        parts_[0][n][bin(x)] += static_cast<float>(length);
        parts_[1][n][bin(y)] += static_cast<float>(length);
      });
    }
  }

  double h_;
  double length_[B * B] = {};
  std::array<float, Bins> parts_[2][B * B] = {};
};

}  // namespace tailrun::mpm

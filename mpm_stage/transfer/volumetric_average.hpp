// Cure of volumetric locking and of the pressure noise that comes with it, for materials that ask for it.
//
// Strain: each particle's volumetric strain increment is replaced by an average over a space coarser than the shape
// functions', so that nearly incompressible flow has fewer volume constraints than degrees of freedom (assumed
// volumetric strain; for material points Coombs et al. 2018, Telikicherla & Moutsanidis 2022, Zhao, Jiang & Choo 2023).
// The increments go, weighted with the particles' volumes, to the grid's linear nodes and come back by the same
// weights.
//
// Stress: mean stresses that differ from one particle to the next within a cell push no node and so are never undone,
// while large deformation keeps making them. Each particle's total mean stress therefore relaxes towards the average
// around it, brought to the node along the hydrostatic gradient so that a body at rest under its weight feels nothing,
// not even at its surface. The relaxation time is h / (relaxation c) with c the wave speed: independent of the time
// step.
#pragma once

#include <algorithm>
#include <array>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// A node's sums: volume-weighted increment, volume, volume-weighted mean stress, mass.
using AveragedNode = Vec4;
// A node's averages: increment (1) and mean stress (Pa).
using NodeMean = Vec2;

template <int Dim>
inline double trace_of(const Particles<Dim>& P, std::size_t p) {
  double t = 0.0;
  for (int d = 0; d < Dim; ++d) t += P.gradient[d * (Dim + 1)][p];
  return t;
}

// Linear weights of the 2^Dim nodes around X (cells from the tile's node 0) of four particles.
template <int Dim, int Side>
struct LinearCell {
  Int4 first;
  Vec4 weight[1 << Dim], fraction[Dim];

  template <class G>
  [[gnu::always_inline]] LinearCell(const Particles<Dim>& P, const G& g, const std::array<double, Dim>& corner,
                                    double h1) {
    int stride = 1;
    Vec4 at = {};
    for (int d = 0; d < Dim; ++d, stride *= Side) {
      const Vec4 X = (g.read(P.position[d].data()) - corner[d]) * h1, cell = truncated(X);
      fraction[d] = X - cell;
      at += cell * stride;
    }
    first = whole(at);
    for (int n = 0; n < (1 << Dim); ++n) {
      weight[n] = splat(1.0);
      for (int d = 0; d < Dim; ++d) weight[n] *= (n >> d & 1) ? fraction[d] : 1.0 - fraction[d];
    }
  }
  static constexpr int offset(int n) {
    int o = 0, stride = 1;
    for (int d = 0; d < Dim; ++d, stride *= Side) o += (n >> d & 1) ? stride : 0;
    return o;
  }
};

// Total mean stress, Pa.
template <int Dim, class G>
[[gnu::always_inline]] inline Vec4 mean_stress(const Particles<Dim>& P, const G& g) {
  const Vec4 m = (g.read(P.stress[0].data()) + g.read(P.stress[1].data()) + g.read(P.stress[2].data())) * (1.0 / 3.0);
  return P.pore_pressure.empty() ? m : m - g.read(P.pore_pressure.data());
}

// `body` is the body acceleration, m/s2.
template <int Dim, class Shape>
void scatter_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                        const std::array<double, Dim>& corner, double h1, const std::array<double, Dim>& body,
                        AveragedNode* tile) {
  const double h = 1.0 / h1;
  constexpr int T = Tile<Dim, Shape>::side;
  Vec4 step[Dim];  // per mass, what the mean stress changes by from one node to the next: - b h
  for (int d = 0; d < Dim; ++d) step[d] = Vec4{0.0, 0.0, -body[d] * h, 0.0};
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        const LinearCell<Dim, T> cell(P, g, corner, h1);
        const Vec4 v = g.read(P.volume.data()), mass = g.read(P.mass.data());
        Vec4 trace = {};
        for (int d = 0; d < Dim; ++d) trace += g.read(P.gradient[d * (Dim + 1)].data());
        // Mean stress at a node: s - rho b (x_node - x_p).
        Vec4 at_first = v * mean_stress(P, g);
        for (int d = 0; d < Dim; ++d) at_first -= cell.fraction[d] * mass * step[d][2];
        Vec4 give[4] = {v * trace, v, at_first, mass};
        transpose(give[0], give[1], give[2], give[3]);
#pragma GCC unroll 4
        for (int k = 0; k < g.count; ++k) {
          AveragedNode* node = one_address(tile + cell.first[k]);
          Vec4 along[Dim];
          for (int d = 0; d < Dim; ++d) along[d] = step[d] * splat(mass[k]);
          for (int n = 0; n < (1 << Dim); ++n) {
            Vec4 there = give[k];
            for (int d = 0; d < Dim; ++d)
              if (n >> d & 1) there += along[d];
            node[cell.offset(n)] += there * splat(cell.weight[n][k]);
          }
        }
      });
}

inline NodeMean node_mean(const AveragedNode& node) {
  const Vec4 volume = splat(node[1]), mean = volume > Vec4{} ? node / volume : Vec4{};
  return __builtin_shufflevector(mean, mean, 0, 2);
}

// `mean` is the tile of the nodes' averages, twice each. trace[0 .. end - begin) is the volumetric increment that the
// stress update reads, shift[...] what it adds to the mean stress: the share `relaxation` of the way to the average.
template <int Dim, class Shape>
void gather_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                       const std::array<double, Dim>& corner, double h1, double relaxation, const Vec4* mean,
                       double* trace, double* shift) {
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        const LinearCell<Dim, Tile<Dim, Shape>::side> cell(P, g, corner, h1);
        Vec4 increment = {}, stress = {};
        for (int n = 0; n < (1 << Dim); ++n) {
          const Vec4* node = mean + cell.offset(n);
          Vec4 lanes[2];
          transpose_doubled(node[cell.first[0]], node[cell.first[1]], node[cell.first[2]], node[cell.first[3]], lanes);
          increment += cell.weight[n] * lanes[0];
          stress += cell.weight[n] * lanes[1];
        }
        auto of_run = g;
        of_run.first -= begin;
        of_run.write(trace, increment);
        of_run.write(shift, relaxation * (stress - mean_stress(P, g)));
      });
}

// Where nothing is averaged: the particles' own increments.
template <int Dim>
void own_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end, double* trace, double* shift) {
  for (std::size_t p = begin; p < end; ++p) trace[p - begin] = trace_of(P, p);
  std::fill(shift, shift + (end - begin), 0.0);
}

// Whether one of n volumetric increments is beyond all measure (or not a number).
inline bool inverts(const double* trace, std::size_t n) {
  Mask4 wrong = {};
  for_each_group(
      0, n, [&](const auto& g) __attribute__((always_inline)) { wrong |= ~(magnitude(g.read(trace)) < splat(1.0)); });
  return (wrong[0] | wrong[1] | wrong[2] | wrong[3]) != 0;
}

}  // namespace tailrun::mpm

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

#include <array>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// A node's sums: volume-weighted increment, volume, volume-weighted mean stress.
using AveragedNode = Vec4;
// A node's averages: increment (1) and mean stress (Pa).
using NodeMean = double __attribute__((vector_size(16)));

template <int Dim>
inline double trace_of(const Particles<Dim>& P, std::size_t p) {
  double t = 0.0;
  for (int d = 0; d < Dim; ++d) t += P.gradient[d * (Dim + 1)][p];
  return t;
}

// Linear weights of the 2^Dim nodes around X (cells from the tile's node 0).
template <int Dim, int Side>
struct LinearCell {
  std::size_t first;
  double weight[1 << Dim], fraction[Dim];

  LinearCell(const Particles<Dim>& P, std::size_t p, const std::array<double, Dim>& corner, double h1) {
    double* f = fraction;
    first = 0;
    std::size_t stride = 1;
    for (int d = 0; d < Dim; ++d, stride *= Side) {
      const double X = (P.position[d][p] - corner[d]) * h1;
      const int cell = static_cast<int>(X);
      f[d] = X - cell;
      first += static_cast<std::size_t>(cell) * stride;
    }
    for (int n = 0; n < (1 << Dim); ++n) {
      weight[n] = 1.0;
      for (int d = 0; d < Dim; ++d) weight[n] *= (n >> d & 1) ? f[d] : 1.0 - f[d];
    }
  }
  static constexpr std::size_t offset(int n) {
    std::size_t o = 0, stride = 1;
    for (int d = 0; d < Dim; ++d, stride *= Side) o += (n >> d & 1) ? stride : 0;
    return o;
  }
};

// Total mean stress, Pa.
template <int Dim>
inline double mean_stress(const Particles<Dim>& P, std::size_t p) {
  const double m = (P.stress[0][p] + P.stress[1][p] + P.stress[2][p]) * (1.0 / 3.0);
  return P.pore_pressure.empty() ? m : m - P.pore_pressure[p];
}

// `body` is the body acceleration, m/s2.
template <int Dim, class Shape>
void scatter_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                        const std::array<double, Dim>& corner, double h1, const std::array<double, Dim>& body,
                        AveragedNode* tile) {
  const double h = 1.0 / h1;
  for (std::size_t p = begin; p < end; ++p) {
    const LinearCell<Dim, Tile<Dim, Shape>::side> cell(P, p, corner, h1);
    const double v = P.volume[p];
    // Mean stress at a node: s - rho b (x_node - x_p).
    double at_first = v * mean_stress(P, p), step[Dim];
    for (int d = 0; d < Dim; ++d) {
      step[d] = -P.mass[p] * body[d] * h;
      at_first -= cell.fraction[d] * step[d];
    }
    const Vec4 give = {v * trace_of(P, p), v, 0.0, 0.0};
    for (int n = 0; n < (1 << Dim); ++n) {
      double s = at_first;
      for (int d = 0; d < Dim; ++d) s += (n >> d & 1) ? step[d] : 0.0;
      tile[cell.first + cell.offset(n)] += splat(cell.weight[n]) * Vec4{give[0], give[1], s, 0.0};
    }
  }
}

inline NodeMean node_mean(const AveragedNode& node) {
  const double r = node[1] > 0.0 ? 1.0 / node[1] : 0.0;
  return NodeMean{node[0] * r, node[2] * r};
}

// `mean` is the tile of the nodes' averages. trace[0 .. end - begin) is the volumetric increment that the stress update
// reads, shift[...] what it adds to the mean stress: the share `relaxation` of the way to the average.
template <int Dim, class Shape>
void gather_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                       const std::array<double, Dim>& corner, double h1, double relaxation, const NodeMean* mean,
                       double* trace, double* shift) {
  for (std::size_t p = begin; p < end; ++p) {
    const LinearCell<Dim, Tile<Dim, Shape>::side> cell(P, p, corner, h1);
    NodeMean t = {};
    for (int n = 0; n < (1 << Dim); ++n)
      t += NodeMean{cell.weight[n], cell.weight[n]} * mean[cell.first + cell.offset(n)];
    trace[p - begin] = t[0];
    shift[p - begin] = relaxation * (t[1] - mean_stress(P, p));
  }
}

}  // namespace tailrun::mpm

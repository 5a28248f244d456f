// Cure of volumetric locking: each particle's volumetric strain increment is replaced by an average over a space
// coarser than the shape functions', so that nearly incompressible flow has fewer volume constraints than degrees of
// freedom (assumed volumetric strain; for material points Coombs et al. 2018, Telikicherla & Moutsanidis 2022, Zhao,
// Jiang & Choo 2023). The increments go, weighted with the particles' volumes, to the grid's linear nodes and come back
// by the same weights; only particles of materials that ask for it give and take.
#pragma once

#include <array>

#include "mpm_stage/grid/block_grid.hpp"

namespace tailrun::mpm {

// Volume-weighted increment and volume at a node, as one value of two lanes.
using AveragedNode = double __attribute__((vector_size(16)));

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
  double weight[1 << Dim];

  LinearCell(const Particles<Dim>& P, std::size_t p, const std::array<double, Dim>& corner, double h1) {
    double f[Dim];
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

template <int Dim, class Shape>
void scatter_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                        const std::array<double, Dim>& corner, double h1, AveragedNode* tile) {
  for (std::size_t p = begin; p < end; ++p) {
    const LinearCell<Dim, Tile<Dim, Shape>::side> cell(P, p, corner, h1);
    const double v = P.volume[p];
    const AveragedNode give = {v * trace_of(P, p), v};
    for (int n = 0; n < (1 << Dim); ++n) {
      tile[cell.first + cell.offset(n)] += AveragedNode{cell.weight[n], cell.weight[n]} * give;
    }
  }
}

// `mean` holds the nodes' averages; trace[0 .. end - begin) is what the stress update reads.
template <int Dim, class Shape>
void gather_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                       const std::array<double, Dim>& corner, double h1, const double* mean, double* trace) {
  for (std::size_t p = begin; p < end; ++p) {
    const LinearCell<Dim, Tile<Dim, Shape>::side> cell(P, p, corner, h1);
    double t = 0.0;
    for (int n = 0; n < (1 << Dim); ++n) t += cell.weight[n] * mean[cell.first + cell.offset(n)];
    trace[p - begin] = t;
  }
}

}  // namespace tailrun::mpm

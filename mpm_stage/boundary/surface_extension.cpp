#include "mpm_stage/boundary/surface_extension.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace tailrun::mpm {

template <int Dim>
void SurfaceExtension<Dim>::update(const BlockGrid<Dim>& grid, std::vector<SurfaceRole> role) {
  role_ = std::move(role);
  beside_.resize(grid.active());
  found_.resize(grid.active());
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < grid.active(); ++a)
    for (int k = 0; k < Block<Dim>::neighbours; ++k) beside_[a][k] = grid.active_beside(a, k);
}

template <int Dim>
double SurfaceExtension<Dim>::heaviest_beside(const Vec4* sums, std::size_t a, int n) const {
  double heaviest = 0.0;
  for (int s = 0; s < Block<Dim>::neighbours; ++s) {
    const auto j = node_beside<Dim>(beside_[a], n, neighbour_step<Dim>(s));
    if (j >= 0 && role_[j] != SurfaceRole::none) heaviest = std::max(heaviest, sums[j][0]);
  }
  return heaviest;
}

template <int Dim>
bool SurfaceExtension<Dim>::is_light(const Vec4* sums, std::size_t k, double heaviest) const {
  return role_[k] == SurfaceRole::any && sums[k][0] > 0.0 && sums[k][0] < share_ * heaviest;
}

template <int Dim>
void SurfaceExtension<Dim>::choose(const Vec4* sums) {
  constexpr int nodes = Block<Dim>::nodes;
  const std::size_t blocks = beside_.size();
  light_.resize(blocks * nodes);
  double most = 0.0;
  for (std::size_t k = 0; k < blocks * nodes; ++k) most = std::max(most, sums[k][0]);
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < blocks; ++a)
    for (int n = 0; n < nodes; ++n) {
      const std::size_t k = a * nodes + static_cast<std::size_t>(n);
      light_[k] = is_light(sums, k, most) && is_light(sums, k, heaviest_beside(sums, a, n));
    }
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t a = 0; a < blocks; ++a) {
    found_[a].continued.clear();
    found_[a].sources.clear();
    for (int n = 0; n < nodes; ++n)
      if (light_[a * nodes + static_cast<std::size_t>(n)]) fit(a, n, sums, heaviest_beside(sums, a, n), found_[a]);
  }
  continued_.clear();
  sources_.clear();
  for (const Found& f : found_) {
    const std::size_t before = sources_.size();
    for (Continued c : f.continued) {
      c.first += before;
      c.last += before;
      continued_.push_back(c);
    }
    sources_.insert(sources_.end(), f.sources.begin(), f.sources.end());
  }
}

// Least squares over the nodes around, weighted with their mass over the fourth power of the distance. A node without
// enough of them around keeps its freedom.
template <int Dim>
void SurfaceExtension<Dim>::fit(std::size_t a, int n, const Vec4* sums, double heaviest, Found& found) const {
  using Basis = Eigen::Matrix<double, Dim + 1, 1>;
  using Square = Eigen::Matrix<double, Dim + 1, Dim + 1>;
  constexpr int width = 2 * reach + 1;
  constexpr int around = power(width, Dim);
  constexpr double least_pivot = 1e-3;  // of the normal equations with diagonal 1
  std::array<Basis, around> basis;
  std::array<double, around> weight;
  std::array<std::size_t, around> node;
  int count = 0;
  Square normal = Square::Zero();
  for (int s = 0; s < around; ++s) {
    std::array<int, Dim> step;
    int far = 0;
    for (int d = 0, r = s; d < Dim; ++d, r /= width) {
      step[d] = r % width - reach;
      far += step[d] * step[d];
    }
    const auto j = node_beside<Dim>(beside_[a], n, step);
    if (j < 0 || light_[j] || role_[j] == SurfaceRole::none || sums[j][0] < share_ * heaviest) continue;
    node[count] = static_cast<std::size_t>(j);
    weight[count] = sums[j][0] / (heaviest * far * far);
    basis[count](0) = 1.0;
    for (int d = 0; d < Dim; ++d) basis[count](1 + d) = step[d];
    normal += weight[count] * basis[count] * basis[count].transpose();
    ++count;
  }
  if (count <= Dim) return;
  const Basis scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Square> factors(scale.asDiagonal() * normal * scale.asDiagonal());
  if (!(factors.vectorD().minCoeff() > least_pivot)) return;
  const Basis value = scale(0) * scale.asDiagonal() * factors.solve(Basis::Unit(0));
  const std::size_t first = found.sources.size();
  for (int i = 0; i < count; ++i) found.sources.push_back({node[i], weight[i] * basis[i].dot(value)});
  const std::size_t k = a * Block<Dim>::nodes + static_cast<std::size_t>(n);
  found.continued.push_back({k, first, found.sources.size(), sums[k][0]});
}

template <int Dim>
void SurfaceExtension<Dim>::fold(Vec4* sums) const {
  for (const Continued& c : continued_) {
    for (std::size_t k = c.first; k < c.last; ++k) sums[sources_[k].node] += sums[c.node] * splat(sources_[k].weight);
    sums[c.node] = Vec4{};
  }
}

// Solves E^T M E v = p for M~ v, M~ being the row sums: v starts as M~^-1 p and is corrected an odd number of times
// (Jacobi). Then, like the exact solution, it amplifies no velocity field, and it keeps linear momentum whatever their
// number; angular momentum as far as they have converged.
template <int Dim>
void SurfaceExtension<Dim>::solve(const Vec4* mass, Vec4* sums) {
  constexpr int corrections = 3;
  given_.resize(sources_.size());
  difference_.resize(sources_.size());
  for (std::size_t k = 0; k < sources_.size(); ++k) given_[k] = sums[sources_[k].node];
  for (int c = 0; c < corrections; ++c) {
    for (const Continued& node : continued_) {
      Vec4 own{};
      for (std::size_t k = node.first; k < node.last; ++k) {
        difference_[k] = sums[sources_[k].node] * splat(1.0 / mass[sources_[k].node][0]);
        own += difference_[k] * splat(sources_[k].weight);
      }
      for (std::size_t k = node.first; k < node.last; ++k)
        difference_[k] = (difference_[k] - own) * splat(sources_[k].weight * node.mass);
    }
    for (std::size_t k = 0; k < sources_.size(); ++k) sums[sources_[k].node] = given_[k];
    for (std::size_t k = 0; k < sources_.size(); ++k) sums[sources_[k].node] += difference_[k];
  }
}

template <int Dim>
void SurfaceExtension<Dim>::fold_momentum(Vec4* sums) {
  fold(sums);
  solve(sums, sums);
}

template <int Dim>
void SurfaceExtension<Dim>::fold_force(const Vec4* sums, Vec4* forces) {
  fold(forces);
  solve(sums, forces);
}

template <int Dim>
void SurfaceExtension<Dim>::extend(Vec4* velocity) const {
  for (const Continued& c : continued_) {
    Vec4 v{};
    for (std::size_t k = c.first; k < c.last; ++k) v += velocity[sources_[k].node] * splat(sources_[k].weight);
    velocity[c.node] = v;
  }
}

template class SurfaceExtension<2>;
template class SurfaceExtension<3>;

}  // namespace tailrun::mpm

// What the explicit solver says of itself: energy, memory, balance of forces, the particle that went wrong; included by
// explicit_solver.hpp.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::elastic_energy() const {
  double energy = 0.0;
  for (std::size_t b = 0; b < grid_.occupied(); ++b)
    for (const Run& run : grid_.runs(b))
      energy += mpm::elastic_energy(constants_[run.material], P_, run.begin, run.end);
  return energy;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
std::size_t ExplicitSolver<Dim, Shape, Split, Transfer>::grid_bytes() const {
  return grid_.bytes() + (tiles_.capacity() + velocity_.capacity() + change_.capacity()) * sizeof(Vec4) +
         beside_.capacity() * sizeof(SplitNode<Dim>) + (term_.capacity() + products_.capacity()) * sizeof(Vec4) +
         averaged_tiles_.capacity() * sizeof(PatchSum) + averaged_.capacity() * sizeof(PatchFit) + filling_.bytes();
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
double ExplicitSolver<Dim, Shape, Split, Transfer>::unbalanced_force_ratio(const std::array<double, Dim>& body) const {
  AlignedVector<Vec4> tiles(grid_.occupied() * tile_nodes, Vec4{});
  AlignedVector<SplitNode<Dim>> beside(tiles.size(), SplitNode<Dim>{});
  for (std::size_t b = 0; b < grid_.occupied(); ++b) {
    const std::size_t begin = grid_.first_particle(b), end = grid_.last_particle(b);
    Vec4* m = tiles.data() + b * tile_nodes;
    SplitNode<Dim>* f = beside.data() + b * tile_nodes;
    if (P_.pore_pressure.empty())
      mpm::particles_to_grid<Shape, true, false>(0.0, h1_, corner(b), P_, begin, end, m, f);
    else
      mpm::particles_to_grid<Shape, true, true>(0.0, h1_, corner(b), P_, begin, end, m, f);
    if (water_.any()) water_.template scatter<Shape, true>(grid_, b, 0.0, corner(b), P_, begin, end, m, f);
  }
  double unbalanced = 0.0, weight = 0.0;
  for (std::size_t a = 0; a < grid_.active(); ++a) {
    Vec4 m[block_nodes], f[block_nodes];
    gather_sums<Dim, Shape, true>(grid_.tiles_around(a), tiles.data(), beside.data(), m, f);
    const NodeContact* contact = ground_.of_block(a);
    for (int n = 0; n < block_nodes; ++n) {
      // What the ground bears counts for nothing, nor do nodes whose functions reach into it: there is its share in
      // theirs.
      if (m[n][0] <= mass_cutoff_ || (contact && (contact[n].count > 0 || contact[n].beside))) continue;
      bool held = false;
      const std::array<int, Dim> node = grid_.node_index(a, n);
      for (int d = 0; d < Dim; ++d)
        for (int s = 0; s < 2; ++s) {
          const auto& side = wall_nodes_.side[d][s];
          held =
              held || (side.kind != WallKind::open && (s == 0 ? node[d] <= side.node + 1 : node[d] >= side.node - 1));
        }
      if (held) continue;
      for (int d = 0; d < Dim; ++d) {
        const double g = m[n][0] * body[d], r = f[n][1 + d] + g;
        unbalanced += r * r;
        weight += g * g;
      }
    }
  }
  return weight > 0.0 ? std::sqrt(unbalanced / weight) : 0.0;
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
void ExplicitSolver<Dim, Shape, Split, Transfer>::fail(std::size_t begin, std::size_t end,
                                                       const std::string& what) const {
  // Names the particle that is not finite, else the fastest of the block.
  std::size_t worst = begin;
  double most = -1.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double s = speed_squared(p);
    if (!std::isfinite(s)) {
      worst = p;
      break;
    }
    if (s > most) {
      most = s;
      worst = p;
    }
  }
  throw ComputationError(description(worst) + ", " + what);
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
std::string ExplicitSolver<Dim, Shape, Split, Transfer>::description(std::size_t p) const {
  std::string place;
  for (int d = 0; d < Dim; ++d) place += fmt::format("{}{:.6g}", d ? ", " : "", P_.position[d][p]);
  return fmt::format("particle {} of material '{}' at ({}) m, speed {:.4g} m/s", P_.identity[p],
                     materials_[P_.material[p]].name, place, std::sqrt(speed_squared(p)));
}

template <int Dim, class Shape, bool Split, TransferName Transfer>
std::string ExplicitSolver<Dim, Shape, Split, Transfer>::most_energetic() const {
  std::size_t worst = 0;
  double most = -1.0, kinetic = 0.0, elastic = 0.0;
  for (std::size_t p = 0; p < P_.count() && std::isfinite(most); ++p) {
    const double k = 0.5 * P_.mass[p] * speed_squared(p);
    const double e = mpm::elastic_energy(constants_[P_.material[p]], P_, p, p + 1);
    if ((k + e) / P_.mass[p] <= most) continue;
    worst = p;
    most = (k + e) / P_.mass[p];
    kinetic = k;
    elastic = e;
  }
  return fmt::format("{}, has a kinetic energy of {:.4g} J and an elastic one of {:.4g} J", description(worst), kinetic,
                     elastic);
}

}  // namespace tailrun::mpm

// Material near the ground as a node sees it. The gap: the least clearance of the particles in its reach, a particle
// being a sphere of its own volume's size; a node stops material only when it is closed. The mean, by volume, of the
// shear stress that these particles can carry. And what they cover of the ground.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm_stage/boundary/contact_nodes.hpp"
#include "mpm_stage/boundary/covered_ground.hpp"
#include "mpm_stage/material/soil_limit.hpp"

namespace tailrun::mpm {

// Cells: what counts as closed. A stiff body lifts off by less than this with each of its vibrations; were each of
// these gaps held open, the ground would push in blows and friction, which follows the push, would let go in between.
constexpr double closed_gap = 0.01;

constexpr double no_gap_known = std::numeric_limits<double>::infinity();

// Where tiles overlap the least value wins and sums add up.
template <int Dim>
struct Gap {
  double value = no_gap_known;          // m
  double volume = 0.0, strength = 0.0;  // m3 and m3 Pa, times the node's weights
  // m3 Pa, the same, of soil that sticks: its tractions on the ground, along it, what of them brakes beside nodes in
  // contact (most_drag), and (compression positive) across it.
  double shear = 0.0, held = 0.0, pressure = 0.0;
  GroundCover<Dim> cover;
  Gap& operator+=(const Gap& o) {
    value = std::min(value, o.value);
    volume += o.volume;
    strength += o.strength;
    shear += o.shear;
    held += o.held;
    pressure += o.pressure;
    cover |= o.cover;
    return *this;
  }
};

// Of soil in contact with a surface: along it (its size) and across it (compression positive).
struct Traction {
  double shear = 0.0, pressure = 0.0;  // Pa
};

// Of particle p's total stress on a surface that faces along `across`, of any length.
template <int Dim>
Traction traction_of(const Particles<Dim>& P, std::size_t p, const std::array<double, Dim>& across) {
  double size = 0.0;
  for (const double x : across) size += x * x;
  if (!(size > 0.0)) return {};
  const double sxy = P.stress[3][p];
  std::array<double, Dim> traction;
  if constexpr (Dim == 2) {
    traction = {P.stress[0][p] * across[0] + sxy * across[1], sxy * across[0] + P.stress[1][p] * across[1]};
  } else {
    const double syz = P.stress[4][p], szx = P.stress[5][p];
    traction = {P.stress[0][p] * across[0] + sxy * across[1] + szx * across[2],
                sxy * across[0] + P.stress[1][p] * across[1] + syz * across[2],
                szx * across[0] + syz * across[1] + P.stress[2][p] * across[2]};
  }
  double normal = 0.0, square = 0.0;
  for (int d = 0; d < Dim; ++d) {
    normal += traction[d] * across[d];
    square += traction[d] * traction[d];
  }
  return {.shear = std::sqrt(std::max(0.0, square - normal * normal / size) / size),
          .pressure = (P.pore_pressure.empty() ? 0.0 : P.pore_pressure[p]) - normal / size};
}

// Pa, by which the ground brakes soil beside nodes in contact at most: of soil that flows and sticks all that it
// carries, of frictional soil what it carries without pressure, for it presses on nodes in contact with all of its
// weight.
inline double most_drag(const MaterialConstants& k, double limit, double cohesion, double plastic_strain) {
  if (limit < no_soil_limit) return 0.0;
  return k.flows ? no_soil_limit : softened_cohesion(k, cohesion, softening_share(k, plastic_strain));
}

// The direction in which the distance grows at a particle, whose place in its `cell` of the tile is `f`.
template <int Dim, class Shape>
std::array<double, Dim> away_from_ground(const double* distance, const int* cell, const double* f) {
  constexpr int T = Tile<Dim, Shape>::side;
  std::array<double, Dim> gradient{};
  for (int n = 0; n < (1 << Dim); ++n) {
    int at = 0;
    for (int d = Dim - 1; d >= 0; --d) at = at * T + cell[d] + (n >> d & 1);
    for (int d = 0; d < Dim; ++d) {
      double slope = (n >> d & 1) ? 1.0 : -1.0;
      for (int e = 0; e < Dim; ++e)
        if (e != d) slope *= (n >> e & 1) ? f[e] : 1.0 - f[e];
      gradient[d] += slope * distance[at];
    }
  }
  return gradient;
}

// `distance` is the tile of the nodes' signed distances, infinity where unknown; adds to the tile `gap`. The materials
// are those of the particles' indices.
template <int Dim, class Shape>
void scatter_gaps(const Particles<Dim>& P, std::size_t begin, std::size_t end,
                  const std::vector<MaterialConstants>& materials, const std::array<double, Dim>& corner, double h1,
                  const double* distance, Gap<Dim>* gap) {
  constexpr int T = Tile<Dim, Shape>::side, S = Shape::support;
  for (std::size_t p = begin; p < end; ++p) {
    // Distance at the particle: linear between nodes, exact but for corners of the ground.
    double clearance = 0.0;
    int cell[3] = {0, 0, 0};
    double X[3] = {0, 0, 0}, f[3] = {0, 0, 0};
    for (int d = 0; d < Dim; ++d) {
      X[d] = (P.position[d][p] - corner[d]) * h1;
      cell[d] = static_cast<int>(X[d]);
      f[d] = X[d] - cell[d];
    }
    for (int n = 0; n < (1 << Dim); ++n) {
      double weight = 1.0;
      int at = 0;
      for (int d = Dim - 1; d >= 0; --d) {
        weight *= (n >> d & 1) ? f[d] : 1.0 - f[d];
        at = at * T + cell[d] + (n >> d & 1);
      }
      clearance += weight * distance[at];
    }
    const double size = Dim == 2 ? std::sqrt(P.volume[p]) : std::cbrt(P.volume[p]), height = clearance;
    clearance -= 0.5 * size + closed_gap / h1;
    if (!(clearance < 2.0 / h1)) continue;
    int base[3] = {0, 0, 0};
    double w[3][S], unused[S], moment[S];
    for (int d = 0; d < Dim; ++d) base[d] = Shape::evaluate(X[d], w[d], unused, moment);
    const MaterialConstants& material = materials[static_cast<std::size_t>(P.material[p])];
    const double limit = soil_limit(material, P.strength[p]);
    const double most = most_drag(material, limit, P.strength[p], P.plastic_strain[p]);
    CoveredGround<Dim, S> covered;  // asked for where strength limits what the ground holds
    Traction on_ground;
    double held = 0.0;
    if (limit < no_soil_limit || most > 0.0) {
      const auto away = away_from_ground<Dim, Shape>(distance, cell, f);
      covered = CoveredGround<Dim, S>(X, base, size * h1, height * h1, away);
      if (most > 0.0) {
        on_ground = traction_of<Dim>(P, p, away);
        held = std::min(on_ground.shear, most);
      }
    }
    for (int k = 0; k < (Dim == 3 ? S : 1); ++k)
      for (int j = 0; j < S; ++j)
        for (int i = 0; i < S; ++i) {
          const double weight = w[0][i] * w[1][j] * (Dim == 3 ? w[2][k] : 1.0);
          if (weight <= 0.0) continue;
          const double volume = weight * P.volume[p];
          gap[((base[2] + k) * T + base[1] + j) * T + base[0] + i] += Gap<Dim>{.value = clearance,
                                                                               .volume = volume,
                                                                               .strength = volume * limit,
                                                                               .shear = volume * on_ground.shear,
                                                                               .held = volume * held,
                                                                               .pressure = volume * on_ground.pressure,
                                                                               .cover = covered.from(i, j, k)};
        }
  }
}

}  // namespace tailrun::mpm

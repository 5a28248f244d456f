// Still water against the soil: it presses on the free surface below its level and computes nothing of the water
// itself.
//
// The nodes' forces are minus the integral of N p n over the wetted surface. No surface is looked for: with any
// continuous field q that is the water's pressure p on the wetted surface and 0 on the dry one, the divergence theorem
// makes it
//   f_I = - sum over the particles of V (grad N_I q + N_I grad q),
// a pressure that acts beside the particle's own stress, and the buoyancy of what it stands in. Where q = p all around
// a body the sum over the nodes is Archimedes' force to round-off, without any force sideways; and soil under water,
// whose total stress holds the water's pressure, puts only what is beyond that on the nodes, so that the noise of a
// quadrature by particles is that of its buoyant weight and not that of the water above it.
//
// q = W p with p = gamma (level - y), 0 above the level. The share W is 1 in the water, 0 in empty space that the water
// does not reach, and in the soil between goes by the number of cells to the one and to the other, d_wet and d_dry:
// 1 in the third of the way that is nearer to the water, 0 in the third that is nearer to the dry side, linear between
// the two. So both surfaces, which a grid knows to a cell only, lie where W is constant. In a pond without a dry side W
// is 1 throughout. Ground and walls are passed over: q acts there too, which leaves them to carry what is beyond the
// water's pressure, as pores under a body at rest do.
//
// Water is what is empty, below the level and inside the pond's range. What is empty within the soil there counts as
// full of water. Water that could leave the range over soil that has sunk below its level is noticed and not computed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mpm_stage/boundary/pond.hpp"
#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/grid/tiles.hpp"
#include "mpm_stage/transfer/particles_to_grid.hpp"

namespace tailrun::mpm {

template <int Dim>
class PondedWater {
 public:
  explicit PondedWater(const std::vector<Pond>& ponds) : ponds_(ponds), states_(ponds.size()) {}

  bool any() const { return !ponds_.empty(); }
  // The levels at time t (s).
  void set_time(double t);
  // Whether a level rises or falls just now: what sleeps would not feel it.
  bool moves(double t) const;
  // Whether a level has left the row of cells for which the shares were made.
  bool outdated(double cell_size) const;

  // Makes the shares anew; right after a sort. solid(a, n): whether ground, a wall or a body has node n of active block
  // a.
  template <class Solid>
  void update(const BlockGrid<Dim>& grid, const Particles<Dim>& P, double time, Solid solid) {
    std::vector<std::uint8_t> passed(grid.active() * Block<Dim>::nodes);
    for (std::size_t k = 0; k < passed.size(); ++k)
      passed[k] = solid(k / Block<Dim>::nodes, static_cast<int>(k % Block<Dim>::nodes));
    pass_soil(grid, P, passed);
    map(grid, passed, time);
  }

  // Adds to `tile` and `beside` (particles_to_grid) of occupied block b what the water does to particles begin .. end.
  // `corner` (m) is node 0 of the tile.
  template <class Shape, bool Split>
  void scatter(const BlockGrid<Dim>& grid, std::size_t b, double dt, const std::array<double, Dim>& corner,
               const Particles<Dim>& P, std::size_t begin, std::size_t end, Vec4* tile, SplitNode<Dim>* beside) const;

  // sum of V q over the particles of block b, J: the work that the water takes to give way to them. `levels` (m), of
  // each pond.
  template <class Shape>
  double potential(const BlockGrid<Dim>& grid, std::size_t b, const std::array<double, Dim>& corner,
                   const Particles<Dim>& P, const std::vector<double>& levels) const;

  std::vector<double> levels() const;
  const std::vector<PondState>& states() const { return states_; }
  // Of every pond, one after the other: W at the nodes of the active blocks.
  const std::vector<double>& shares() const { return shares_; }
  void restore(const BlockGrid<Dim>& grid, std::vector<double> shares, std::vector<PondState> states);

 private:
  enum class Role : std::uint8_t { passed, water, dry, air };
  struct Pressure {
    double value;                   // Pa
    std::array<double, Dim> slope;  // Pa/m
  };

  void connect(const BlockGrid<Dim>& grid);
  void pass_soil(const BlockGrid<Dim>& grid, const Particles<Dim>& P, std::vector<std::uint8_t>& passed) const;
  void map(const BlockGrid<Dim>& grid, const std::vector<std::uint8_t>& passed, double time);
  void look_for_leaks(const BlockGrid<Dim>& grid, std::size_t pond, const std::vector<Role>& role, double time);
  std::vector<std::int32_t> cells_from(const std::vector<Role>& role, Role source) const;
  void find_wet_blocks(const BlockGrid<Dim>& grid);
  std::array<double, Dim> place_of(const BlockGrid<Dim>& grid, std::size_t a, int n) const;
  bool in_range(const Pond& pond, const std::array<double, Dim>& x) const;
  bool is_wet(std::size_t pond, std::size_t b) const { return wet_[pond * (wet_.size() / ponds_.size()) + b] != 0; }

  // Of a pond with W at the nodes of a tile of `side` nodes a side, at X cells from its node 0.
  template <int Side>
  Pressure pressure(const double* share, const std::array<double, Dim>& X, double depth, double unit_weight,
                    double h1) const;

  std::vector<Pond> ponds_;
  std::vector<PondState> states_;
  std::vector<double> shares_;
  std::vector<std::uint8_t> wet_;  // of every pond, by occupied block: W is not 0 all over its tile
  std::vector<std::array<int, Block<Dim>::neighbours>> beside_;  // active blocks around active blocks
};

template <int Dim>
template <int Side>
typename PondedWater<Dim>::Pressure PondedWater<Dim>::pressure(const double* share, const std::array<double, Dim>& X,
                                                               double depth, double unit_weight, double h1) const {
  // W is linear between nodes, along each direction.
  int start = 0;
  std::array<double, Dim> f;
  for (int d = 0, stride = 1; d < Dim; ++d, stride *= Side) {
    const int i = static_cast<int>(X[d]);
    f[d] = X[d] - i;
    start += i * stride;
  }
  double W = 0.0;
  std::array<double, Dim> slope{};
  for (int corner = 0; corner < power(2, Dim); ++corner) {
    double weight = 1.0;
    int node = start;
    for (int d = 0, stride = 1; d < Dim; ++d, stride *= Side) {
      const bool upper = (corner >> d & 1) != 0;
      weight *= upper ? f[d] : 1.0 - f[d];
      node += upper ? stride : 0;
    }
    W += weight * share[node];
    for (int d = 0; d < Dim; ++d) {
      double other = (corner >> d & 1) != 0 ? h1 : -h1;
      for (int e = 0; e < Dim; ++e)
        if (e != d) other *= (corner >> e & 1) != 0 ? f[e] : 1.0 - f[e];
      slope[d] += other * share[node];
    }
  }
  Pressure q{W * unit_weight * depth, {}};
  for (int d = 0; d < Dim; ++d) q.slope[d] = slope[d] * unit_weight * depth;
  q.slope[1] -= W * unit_weight;
  return q;
}

template <int Dim>
template <class Shape, bool Split>
void PondedWater<Dim>::scatter(const BlockGrid<Dim>& grid, std::size_t b, double dt,
                               const std::array<double, Dim>& corner, const Particles<Dim>& P, std::size_t begin,
                               std::size_t end, Vec4* tile, SplitNode<Dim>* beside) const {
  constexpr int S = Shape::support, T = Tile<Dim, Shape>::side;
  const double h1 = 1.0 / grid.cell_size(), unit = -(Split ? 1.0 : dt);
  double share[Tile<Dim, Shape>::nodes];
  for (std::size_t k = 0; k < ponds_.size(); ++k) {
    if (!is_wet(k, b)) continue;
    load_tile<Dim, Shape>(grid, b, shares_.data() + k * grid.active() * Block<Dim>::nodes, share);
    for (std::size_t p = begin; p < end; ++p) {
      const double depth = states_[k].level - P.position[1][p];
      if (!(depth > 0.0)) continue;
      std::array<double, Dim> X;
      double w[3][S], d[3][S], unused[S];
      int base[3] = {};
      for (int a = 0; a < Dim; ++a) {
        X[a] = (P.position[a][p] - corner[a]) * h1;
        base[a] = Shape::evaluate(X[a], w[a], d[a], unused);
      }
      const Pressure q = pressure<T>(share, X, depth, ponds_[k].unit_weight, h1);
      const double V = unit * P.volume[p], slope_unit = V * q.value * h1;
      for (int l = 0; l < (Dim == 3 ? S : 1); ++l)
        for (int j = 0; j < S; ++j)
          for (int i = 0; i < S; ++i) {
            const double wz = Dim == 3 ? w[2][l] : 1.0;
            const double N = V * w[0][i] * w[1][j] * wz;
            const double fx = slope_unit * d[0][i] * w[1][j] * wz + N * q.slope[0];
            const double fy = slope_unit * w[0][i] * d[1][j] * wz + N * q.slope[1];
            const int node = ((base[2] + l) * T + base[1] + j) * T + base[0] + i;
            if constexpr (Dim == 2) {
              // Momentum and forces fill the four lanes, or follow the mass.
              if constexpr (Split)
                tile[node] += Vec4{0.0, 0.0, fx, fy};
              else
                tile[node] += Vec4{0.0, fx, fy, 0.0};
            } else {
              const double fz = slope_unit * w[0][i] * w[1][j] * d[2][l] + N * q.slope[2];
              (Split ? beside : tile)[node] += Vec4{0.0, fx, fy, fz};
            }
          }
    }
  }
}

template <int Dim>
template <class Shape>
double PondedWater<Dim>::potential(const BlockGrid<Dim>& grid, std::size_t b, const std::array<double, Dim>& corner,
                                   const Particles<Dim>& P, const std::vector<double>& levels) const {
  const double h1 = 1.0 / grid.cell_size();
  double share[Tile<Dim, Shape>::nodes];
  double sum = 0.0;
  for (std::size_t k = 0; k < ponds_.size(); ++k) {
    if (!is_wet(k, b)) continue;
    load_tile<Dim, Shape>(grid, b, shares_.data() + k * grid.active() * Block<Dim>::nodes, share);
    for (std::size_t p = grid.first_particle(b); p < grid.last_particle(b); ++p) {
      const double depth = levels[k] - P.position[1][p];
      if (!(depth > 0.0)) continue;
      std::array<double, Dim> X;
      for (int a = 0; a < Dim; ++a) X[a] = (P.position[a][p] - corner[a]) * h1;
      sum += P.volume[p] * pressure<Tile<Dim, Shape>::side>(share, X, depth, ponds_[k].unit_weight, h1).value;
    }
  }
  return sum;
}

}  // namespace tailrun::mpm

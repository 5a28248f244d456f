// P2G: particles add mass, momentum and internal forces to the nodes of their block's tile.
//
// A node is one value of four lanes: (m, px, py, 0) in 2-D, (m, px, py, pz) in 3-D. What particle p gives to node (i,
// j) separates into w_x(i) A_j + w_y(j) E_i with vectors A_j, E_i made once per particle.
//
// With Split, momentum before forces and forces stay apart (FLIP and local damping need both). In 3-D a node's forces
// are a second value, (0, fx, fy, fz); in 2-D momentum and forces fill the four lanes, (px, py, fx, fy), and mass lies
// beside them as a number of its own.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/grid/tiles.hpp"

namespace tailrun::mpm {

// What a node has beside its first four lanes where momentum and forces are apart.
template <int Dim>
using SplitNode = std::conditional_t<Dim == 2, double, Vec4>;

// a, b, c, d as the columns of four rows.
[[gnu::always_inline]] inline void transposed(Vec4 a, Vec4 b, Vec4 c, Vec4 d, Vec4* rows) {
  transpose(a, b, c, d);
  rows[0] = a;
  rows[1] = b;
  rows[2] = c;
  rows[3] = d;
}

// The masses of a tile's nodes, added up a row of four nodes at a time. A particle's row begins at any node, so there
// are four copies, of which copy s has its rows of four begin at nodes s, s + 4, ...: loads and stores stay aligned,
// and none reads what is part of one row and part of another.
template <int Side, int Nodes>
class MassRows {
 public:
  // Where in rows() the row of four is that begins at node i of line j; the next line's is `stride` further on.
  static constexpr int stride = 1 + (Side + 3) / 4;
  [[gnu::always_inline]] static Int4 at(Int4 i, Int4 j) { return ((i & 3) * Side + j) * stride + (i >> 2) + 1; }
  Vec4* rows() { return &rows_[0][0][0]; }

  // mass[0 .. Nodes) += the sums.
  void add_to(double* mass) const {
    for (int j = 0; j < Side; ++j) {
      alignas(Vec4) double line[length] = {};
      for (int s = 0; s < 4; ++s) {
        const double* from = reinterpret_cast<const double*>(rows_[s][j]) + 4 - s;
        for (int i = 0; i < length; ++i) line[i] += from[i];
      }
      for (int i = 0; i < Side; ++i) mass[j * Side + i] += line[i];
    }
  }

 private:
  static_assert(Side * Side == Nodes);
  static constexpr int length = 4 * (stride - 1);
  Vec4 rows_[4][Side][stride] = {};
};

// The sums of an active block's nodes over the tiles around it: (m, px, py, pz), and forces (0, fx, fy, fz) with Split.
template <int Dim, class Shape, bool Split>
void gather_sums(const std::array<int, Block<Dim>::neighbours>& around, const Vec4* tiles, const SplitNode<Dim>* beside,
                 Vec4* sum, Vec4* force) {
  if constexpr (Split && Dim == 2) {
    Vec4 both[Block<Dim>::nodes];
    double mass[Block<Dim>::nodes];
    gather_tiles<Dim, Shape>(around, tiles, both);
    gather_tiles<Dim, Shape>(around, beside, mass);
    for (int n = 0; n < Block<Dim>::nodes; ++n) {
      sum[n] = __builtin_shufflevector(both[n], Vec4{mass[n]}, 4, 0, 1, 5);
      force[n] = __builtin_shufflevector(both[n], Vec4{}, 4, 2, 3, 4);
    }
  } else {
    gather_tiles<Dim, Shape>(around, tiles, sum);
    if constexpr (Split) gather_tiles<Dim, Shape>(around, beside, force);
  }
}

// Without Split, `tile` gets the momentum after the step's internal forces, m v + dt f, and `beside` is not touched;
// with Split see above; forces in N. `corner` (m) is node 0 of the tile. HasPore: stress minus pore pressure acts.
template <class Shape, bool Split, bool HasPore>
void particles_to_grid(double dt, double h1, const std::array<double, 2>& corner, const Particles<2>& P,
                       std::size_t begin, std::size_t end, Vec4* __restrict tile, SplitNode<2>* __restrict beside) {
  using At = ShapeAt<Shape>;
  constexpr int S = Shape::support, T = Tile<2, Shape>::side;
  const double h = At::moment_unit / h1;
  const double stress_unit = -(Split ? 1.0 : dt) * h1 * At::slope_unit;
  const bool affine = !P.affine[0].empty();
  [[maybe_unused]] std::conditional_t<Split, MassRows<T, Tile<2, Shape>::nodes>, char> masses;
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        // Four particles at a time, until each one's A_j and E_i are known.
        const At x((g.read(P.position[0].data()) - corner[0]) * h1), y((g.read(P.position[1].data()) - corner[1]) * h1);
        const Int4 base = whole(y.base * T + x.base);
        const Vec4 m = g.read(P.mass.data()), vol = stress_unit * g.read(P.volume.data());
        const Vec4 px = m * g.read(P.velocity[0].data()), py = m * g.read(P.velocity[1].data());
        Vec4 Cxx = {}, Cxy = {}, Cyx = {}, Cyy = {};
        if (affine) {
          const Vec4 mh = m * h;
          Cxx = mh * g.read(P.affine[0].data());
          Cxy = mh * g.read(P.affine[1].data());
          Cyx = mh * g.read(P.affine[2].data());
          Cyy = mh * g.read(P.affine[3].data());
        }
        Vec4 xx = g.read(P.stress[0].data()), yy = g.read(P.stress[1].data());
        if constexpr (HasPore) {
          const Vec4 u = g.read(P.pore_pressure.data());
          xx -= u;
          yy -= u;
        }
        xx *= vol;
        yy *= vol;
        const Vec4 xy = vol * g.read(P.stress[3].data());
        const Vec4 zero = {};
        Vec4 A[S][4], E[S][4], ax[S], ay[S], ex[S], ey[S];  // A, E: [.][particle]
        if constexpr (Split) {
          Vec4 qx[S], qy[S], fx[S], fy[S];
          y.spread_moment(Cxy, ax);
          y.spread_moment(Cyy, ay);
          x.spread_moment(Cxx, ex);
          x.spread_moment(Cyx, ey);
          y.spread_slope(xy, qx);
          y.spread_slope(yy, qy);
          x.spread_slope(xx, fx);
          x.spread_slope(xy, fy);
          for (int j = 0; j < S; ++j) {
            transposed(ax[j] + px * y.w[j], ay[j] + py * y.w[j], qx[j], qy[j], A[j]);
            transposed(ex[j], ey[j], fx[j], fy[j], E[j]);
          }
        } else {
          y.spread_both(xy, Cxy, ax);
          y.spread_both(yy, Cyy, ay);
          x.spread_both(xx, Cxx, ex);
          x.spread_both(xy, Cyx, ey);
          for (int j = 0; j < S; ++j) {
            transposed(m * y.w[j], ax[j] + px * y.w[j], ay[j] + py * y.w[j], zero, A[j]);
            transposed(zero, ex[j], ey[j], zero, E[j]);
          }
        }
        Vec4 line[4], share[S];
        Int4 line_at = {};
        if constexpr (Split) {
          line_at = masses.at(whole(x.base), whole(y.base));
          transposed(x.w[0], x.w[1], S > 2 ? x.w[2] : zero, S > 3 ? x.w[S - 1] : zero, line);
          for (int j = 0; j < S; ++j) share[j] = m * y.w[j];
        }
#pragma GCC unroll 4
        for (int k = 0; k < g.count; ++k) {
          Vec4* node = one_address(tile + base[k]);
          Vec4 w[S], e[S];
          for (int i = 0; i < S; ++i) {
            w[i] = splat(x.w[i][k]);
            e[i] = E[i][k];
          }
          for (int j = 0; j < S; ++j) {
            const Vec4 wj = splat(y.w[j][k]), a = A[j][k];
            for (int i = 0; i < S; ++i) node[j * T + i] += a * w[i] + e[i] * wj;
          }
          if constexpr (Split) {
            Vec4* row = one_address(masses.rows() + line_at[k]);
            for (int j = 0; j < S; ++j) row[j * masses.stride] += line[k] * splat(share[j][k]);
          }
        }
      });
  if constexpr (Split) masses.add_to(beside);
}

template <class Shape, bool Split, bool HasPore>
void particles_to_grid(double dt, double h1, const std::array<double, 3>& corner, const Particles<3>& P,
                       std::size_t begin, std::size_t end, Vec4* __restrict momentum, SplitNode<3>* __restrict force) {
  constexpr int S = Shape::support, T = Tile<3, Shape>::side;
  const double h = 1.0 / h1;
  const bool affine = !P.affine[0].empty();
  for (std::size_t p = begin; p < end; ++p) {
    double w[3][S], d[3][S], q[3][S];
    int base[3];
    for (int a = 0; a < 3; ++a) base[a] = Shape::evaluate((P.position[a][p] - corner[a]) * h1, w[a], d[a], q[a]);
    const double m = P.mass[p], mh = m * h, u = HasPore ? P.pore_pressure[p] : 0.0;
    const double vol = (Split ? 1.0 : dt) * h1 * P.volume[p];
    const Vec4 still = {m, m * P.velocity[0][p], m * P.velocity[1][p], m * P.velocity[2][p]};
    Vec4 C[3] = {}, Sg[3];
    if (affine)
      for (int a = 0; a < 3; ++a)
        C[a] = Vec4{0.0, mh * P.affine[a][p], mh * P.affine[3 + a][p], mh * P.affine[6 + a][p]};
    const double xy = vol * P.stress[3][p], yz = vol * P.stress[4][p], zx = vol * P.stress[5][p];
    Sg[0] = Vec4{0.0, vol * (P.stress[0][p] - u), xy, zx};
    Sg[1] = Vec4{0.0, xy, vol * (P.stress[1][p] - u), yz};
    Sg[2] = Vec4{0.0, zx, yz, vol * (P.stress[2][p] - u)};
    for (int k = 0; k < S; ++k)
      for (int j = 0; j < S; ++j) {
        const std::size_t start = (static_cast<std::size_t>(base[2] + k) * T + base[1] + j) * T + base[0];
        const double wjk = w[1][j] * w[2][k];
        Vec4 A = still * splat(wjk) + C[1] * splat(q[1][j] * w[2][k]) + C[2] * splat(w[1][j] * q[2][k]);
        const Vec4 Q = Sg[1] * splat(-d[1][j] * w[2][k]) + Sg[2] * splat(-w[1][j] * d[2][k]);
        if constexpr (!Split) A += Q;
        for (int i = 0; i < S; ++i) {
          Vec4 E = C[0] * splat(q[0][i]);
          if constexpr (!Split) E -= Sg[0] * splat(d[0][i]);
          momentum[start + i] += A * splat(w[0][i]) + E * splat(wjk);
          if constexpr (Split) force[start + i] += Q * splat(w[0][i]) - Sg[0] * splat(d[0][i] * wjk);
        }
      }
  }
}

}  // namespace tailrun::mpm

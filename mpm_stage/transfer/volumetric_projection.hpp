// Cure of volumetric locking and of the pressure noise that comes with it, for materials that ask for it.
//
// After each step the stress that works on a change of volume is projected on fields that are linear in each patch of
// 2^Dim cells: 3 numbers for 4 cells in 2-D and 4 for 8 in 3-D, fewer than the nodes have degrees of freedom (the
// pressures of the Q2/P1 element, Crouzeix & Raviart 1973; material points have been given averages of the strain
// alone: Coombs et al. 2018, Zhao, Jiang & Choo 2023). With p that stress, e the particle's own volumetric increment
// and K the modulus between them, p is to go to A (p + K e), so the increment that the stress update gets is
//   e' = (A (p + K e) - p) / K.
// A is the least-squares fit weighted with V / K. In the product <a, b> = sum V a b / K it is an orthogonal projection,
// and sum V p^2 / (2 K) is the energy of the changes of volume:
// - The cure cannot make energy. What is stored after the step, <A (p + K e), A (p + K e)> / 2, is at most what would
// be
//   stored without it, <p + K e, p + K e> / 2, for a projection makes nothing longer; and the nodes' forces are the
//   plain ones of the particles' stresses, which do the work <p, K e>. So it is for any A and any materials side by
//   side, also while particles go from patch to patch. Averaging increments alone has no such bound: -<(1 - A) p, K e>,
//   work of stresses on increments that were averaged away, has either sign.
// - p that is linear, as at rest under gravity, is a fixed point everywhere, up to the surface and in patches that are
//   filled in part; so is every field that is linear in each patch. A A = A, so a body at rest does not creep.
// - Noise under the patches' resolution is gone within the step. In each patch the sum of V e is kept (of V K e and
//   V p / K where moduli differ): volume only goes from one particle to the other, and p stays what V makes of it.
//
// A patch's sums lie where its 2^Dim nodes would be in tiles and blocks, so they are added up as the nodes' are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"
#include "mpm_stage/material/material.hpp"
#include "mpm_stage/transfer/sparse_patches.hpp"

namespace tailrun::mpm {

// One of a patch's sums over its particles at X (cells, from the patch's centre), with weights a = V / K and q = p + K
// e: number 0 is a (1, q, X_0 X_1, q^2), number 1 + d is a X_d (1, q, X_d, 0) but for the last numbers, V of number 1
// and the mass of number 2; number 4, in 3-D, is a (X_1 X_2, X_2 X_0, 0, 0).
using PatchSum = Vec4;
// A patch's linear function: number 0 is the value at its centre and the slopes per cell, Pa; number 1 is the share of
// the way to it that the particles go, the patch's crowding (patch_filling.hpp), and the share of its increments that
// sparse soil takes (sparse_patches.hpp).
using PatchFit = Vec4;

// What the elastic law has for changes of volume.
template <int Dim>
struct VolumetricLaw {
  // Pa. In plane strain the normal stress out of the plane does no work: p is the mean of the two in the plane, K is
  // lambda + mu. Viscous normal stresses leave the mean of all three.
  double modulus, flexibility, plane, out_of_plane;

  explicit VolumetricLaw(const MaterialConstants& k) {
    const bool of_three = Dim == 3 || k.mu == 0.0;
    plane = of_three ? 1.0 / 3.0 : 0.5;
    out_of_plane = of_three ? 1.0 / 3.0 : 0.0;
    modulus =
        (of_three ? k.bulk : k.lambda + k.mu) + (k.pore_pressure == PorePressure::undrained ? k.pore_stiffness : 0.0);
    flexibility = 1.0 / modulus;
  }
  // p of particles, Pa.
  template <class G>
  [[gnu::always_inline]] Vec4 stress(const Particles<Dim>& P, const G& g) const {
    const Vec4 p =
        plane * (g.read(P.stress[0].data()) + g.read(P.stress[1].data())) + out_of_plane * g.read(P.stress[2].data());
    return P.pore_pressure.empty() ? p : p - g.read(P.pore_pressure.data());
  }
};

template <int Dim>
inline double trace_of(const Particles<Dim>& P, std::size_t p) {
  double t = 0.0;
  for (int d = 0; d < Dim; ++d) t += P.gradient[d * (Dim + 1)][p];
  return t;
}

// Where a patch has its number n, counted from its first node, in an array with `Side` nodes a side.
template <int Side>
constexpr int patch_offset(int n) {
  return (n & 1) + (n >> 1 & 1) * Side + (n >> 2) * Side * Side;
}

// The patches of four particles: the first node in a tile that begins at `corner` (m), and the places in the patch.
// Patches end at nodes, as walls, bodies and layers of soil do as a rule: a footing's resistance comes out evener so
// than with patches that end in the middle of cells.
template <int Dim, class Shape>
struct InPatch {
  static constexpr int Side = Tile<Dim, Shape>::side;
  Int4 first;
  Vec4 X[Dim];

  template <class G>
  [[gnu::always_inline]] InPatch(const Particles<Dim>& P, const G& g, const std::array<double, Dim>& corner,
                                 double h1) {
    int stride = 1;
    Vec4 at = {};
    for (int d = 0; d < Dim; ++d, stride *= Side) {
      const Vec4 x = (g.read(P.position[d].data()) - corner[d]) * h1, low = 2.0 * truncated(0.5 * x);
      X[d] = x - low - 1.0;
      at += low * stride;
    }
    first = whole(at);
  }
};

template <int Dim, class Shape>
void scatter_volumetric(const MaterialConstants& material, const Particles<Dim>& P, std::size_t begin, std::size_t end,
                        const std::array<double, Dim>& corner, double h1, PatchSum* tile) {
  constexpr int T = Tile<Dim, Shape>::side, sums = Dim == 2 ? 3 : 5;
  const VolumetricLaw<Dim> law(material);
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        const InPatch<Dim, Shape> in(P, g, corner, h1);
        Vec4 trace = {};
        for (int d = 0; d < Dim; ++d) trace += g.read(P.gradient[d * (Dim + 1)].data());
        const Vec4 v = g.read(P.volume.data()), a = law.flexibility * v, q = law.stress(P, g) + law.modulus * trace;
        const Vec4 aq = a * q, aX = a * in.X[0];
        Vec4 give[sums][4] = {};
        give[0][0] = a;
        give[0][1] = aq;
        give[0][2] = aX * in.X[1];
        give[0][3] = aq * q;
        for (int d = 0; d < Dim; ++d) {
          give[1 + d][0] = a * in.X[d];
          give[1 + d][1] = aq * in.X[d];
          give[1 + d][2] = give[1 + d][0] * in.X[d];
        }
        give[1][3] = v;
        give[2][3] = g.read(P.mass.data());
        if constexpr (Dim == 3) {
          give[4][0] = a * in.X[1] * in.X[2];
          give[4][1] = aX * in.X[2];
        }
        for (int n = 0; n < sums; ++n) transpose(give[n][0], give[n][1], give[n][2], give[n][3]);
#pragma GCC unroll 4
        for (int k = 0; k < g.count; ++k) {
          PatchSum* patch = one_address(tile + in.first[k]);
          for (int n = 0; n < sums; ++n) patch[patch_offset<T>(n)] += give[n][k];
        }
      });
}

// The linear functions of the patches of a block from their sums; both have Block::nodes values.
//
// Second moments get 1e-12 (cells squared) more on the diagonal. So patches whose particles lie on a point or a line
// need no case of their own; A stays symmetric and still makes nothing longer.
//
// Where a shock goes through a patch, soil crushed to a fraction of its volume lies beside soil that is whole. There
// the particles go but a share of the way, the same in the whole patch, so that all of the above still holds: as much
// as gives them volumetric increments of 0.02 (root mean square). Elsewhere increments are far below.
template <int Dim>
void fit_patches(const PatchSum* sum, PatchFit* fit, const SparsePatches& sparse = {}) {
  constexpr int B = Block<Dim>::cells, layers = Dim == 2 ? 1 : B;
  constexpr double ridge = 1e-12, most = 0.02;
  for (int k = 0; k < layers; k += 2)
    for (int j = 0; j < B; j += 2)
      for (int i = 0; i < B; i += 2) {
        const PatchSum* s = sum + (k * B + j) * B + i;
        PatchFit& out = fit[(k * B + j) * B + i];
        out = PatchFit{};
        if (!(s[0][0] > 0.0)) continue;
        const double per_weight = 1.0 / s[0][0], average = s[0][1] * per_weight;
        double x[Dim], C[Dim][Dim], b[Dim], slope[Dim];
        for (int d = 0; d < Dim; ++d) {
          const PatchSum along = s[patch_offset<B>(1 + d)] * splat(per_weight);
          x[d] = along[0];
          b[d] = along[1] - x[d] * average;
          C[d][d] = along[2] - x[d] * x[d] + ridge;
        }
        C[0][1] = s[0][2] * per_weight - x[0] * x[1];
        if constexpr (Dim == 2) {
          const double r = 1.0 / (C[0][0] * C[1][1] - C[0][1] * C[0][1]);
          slope[0] = (C[1][1] * b[0] - C[0][1] * b[1]) * r;
          slope[1] = (C[0][0] * b[1] - C[0][1] * b[0]) * r;
        } else {
          C[1][2] = s[patch_offset<B>(4)][0] * per_weight - x[1] * x[2];
          C[0][2] = s[patch_offset<B>(4)][1] * per_weight - x[2] * x[0];
          // C = L D L^T (Cholesky).
          const double l1 = C[0][1] / C[0][0], l2 = C[0][2] / C[0][0], c12 = C[1][2] - l1 * C[0][2];
          const double d1 = C[1][1] - l1 * C[0][1], l3 = c12 / d1, d2 = C[2][2] - l2 * C[0][2] - l3 * c12;
          const double b1 = b[1] - l1 * b[0];
          slope[2] = (b[2] - l2 * b[0] - l3 * b1) / d2;
          slope[1] = b1 / d1 - l3 * slope[2];
          slope[0] = b[0] / C[0][0] - l1 * slope[1] - l2 * slope[2];
        }
        // What the fit leaves of the mean of q^2, and the share that takes its root down to `most` of K.
        double rest = s[0][3] * per_weight - average * average;
        out[0] = average;
        for (int d = 0; d < Dim; ++d) {
          rest -= b[d] * slope[d];
          out[0] -= x[d] * slope[d];
          out[1 + d] = slope[d];
        }
        const double volume = s[patch_offset<B>(1)][3], allowed = most * volume * per_weight;
        double spread = 0.0;
        for (int d = 0; d < Dim; ++d) spread += C[d][d];
        (&out)[patch_offset<B>(1)] = Vec4{rest > allowed * allowed ? allowed / std::sqrt(rest) : 1.0, 0.0,
                                          sparse.active() ? sparse.share(volume, spread) : 1.0, 0.0};
      }
}

// Shear strain (engineering) of the step, from the midpoint gradient.
template <int Dim, class G>
[[gnu::always_inline]] inline Vec4 shear_of(const Particles<Dim>& P, const G& g) {
  Vec4 squared = {}, mean = {};
  for (int d = 0; d < Dim; ++d) mean += g.read(P.gradient[d * (Dim + 1)].data()) * (1.0 / Dim);
  for (int i = 0; i < Dim; ++i) {
    const Vec4 own = g.read(P.gradient[i * (Dim + 1)].data()) - mean;
    squared += 2.0 * own * own;
    for (int j = 0; j < i; ++j) {
      const Vec4 both = g.read(P.gradient[i * Dim + j].data()) + g.read(P.gradient[j * Dim + i].data());
      squared += both * both;
    }
  }
  return root(squared);
}

// `fit` is the tile of the patches' functions. increment[0 .. end - begin) is the volumetric increment e' for the
// stress update; where patches are crowded, less `relief` of that per unit of shear strain; with `soften` the share of
// it that sparse patches take. Returns the elastic energy (J, per metre in plane strain) that the particles get by the
// relief.
template <int Dim, class Shape>
double gather_volumetric(const MaterialConstants& material, const Particles<Dim>& P, std::size_t begin, std::size_t end,
                         const std::array<double, Dim>& corner, double h1, const PatchFit* fit, double relief,
                         double* increment, bool soften = false) {
  constexpr int T = Tile<Dim, Shape>::side;
  constexpr double most = 0.01;  // of volumetric strain in a step
  const VolumetricLaw<Dim> law(material);
  const auto energy_after = [&] {
    if constexpr (Dim == 2)
      return material.plane.energy_after;
    else
      return material.solid.energy_after;
  }();
  Vec4 given = {};
  for_each_group(
      begin, end, [&](const auto& g) __attribute__((always_inline)) {
        const InPatch<Dim, Shape> in(P, g, corner, h1);
        Vec4 of[4];
        transpose_nodes(fit[in.first[0]], fit[in.first[1]], fit[in.first[2]], fit[in.first[3]], of);
        Vec4 fitted = of[0], trace = {};
        for (int d = 0; d < Dim; ++d) {
          fitted += in.X[d] * of[1 + d];
          trace += g.read(P.gradient[d * (Dim + 1)].data());
        }
        const Vec4* second = fit + patch_offset<T>(1);
        const Vec4 share = {second[in.first[0]][0], second[in.first[1]][0], second[in.first[2]][0],
                            second[in.first[3]][0]};
        auto of_run = g;
        of_run.first -= begin;
        const Vec4 p = law.stress(P, g);
        Vec4 e = trace + share * ((fitted - p) * law.flexibility - trace);
        if (relief > 0.0) {
          const Vec4 crowding = {second[in.first[0]][1], second[in.first[1]][1], second[in.first[2]][1],
                                 second[in.first[3]][1]};
          // Nothing that pulls is crowded, nor does relief make it pull: where tension is cut off it would store
          // nothing.
          const Vec4 held = p * law.flexibility + e, none = {};
          const Vec4 wanted = smaller(larger(relief * crowding * shear_of<Dim>(P, g), splat(-most)), splat(most));
          const Vec4 d = held < none ? larger(wanted, held) : none;
          if (energy_after == nullptr) {
            given += g.only(g.read(P.volume.data()) * d * (0.5 * law.modulus * d - p - law.modulus * e));
          } else {
            for (int k = 0; k < g.count; ++k)
              if (d[k] != 0.0)
                given[k] += energy_after(material, P, g.first + static_cast<std::size_t>(k), e[k] - d[k]) -
                            energy_after(material, P, g.first + static_cast<std::size_t>(k), e[k]);
          }
          e -= d;
        }
        if (soften)
          e *= Vec4{second[in.first[0]][2], second[in.first[1]][2], second[in.first[2]][2], second[in.first[3]][2]};
        of_run.write(increment, e);
      });
  return sum_of_lanes(given);
}

// Where nothing is projected: the particles' own increments.
template <int Dim>
void own_volumetric(const Particles<Dim>& P, std::size_t begin, std::size_t end, double* trace) {
  for (std::size_t p = begin; p < end; ++p) trace[p - begin] = trace_of(P, p);
}

// Whether one of n volumetric increments is beyond all measure (or not a number).
inline bool inverts(const double* trace, std::size_t n) {
  Mask4 wrong = {};
  for_each_group(
      0, n, [&](const auto& g) __attribute__((always_inline)) { wrong |= ~(magnitude(g.read(trace)) < splat(1.0)); });
  return (wrong[0] | wrong[1] | wrong[2] | wrong[3]) != 0;
}

}  // namespace tailrun::mpm

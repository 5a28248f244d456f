// Soil that lies about in single particles, made softer, so that steps need not be shorter for it than for bodies.
//
// A few particles alone on their nodes breathe faster than any wave in a body (step/lone_particle.hpp): in the plane,
// AFLIP's B-splines bear steps of h / c in bodies, half of it in one particle. What breathes is their volume. So where
// the patches of volumetric_projection.hpp are sparse, only a share of the projected volumetric increment goes into
// stress and volume, as if the soil there had that share of its stiffness: the step that a lone particle bears grows by
// 1 / sqrt(share). Sparse is what fills little of a patch or lies close together in it. Where a patch is filled evenly,
// by three quarters or more, nothing changes; flow and friction are nobody's elastic volume, and drops are stress-free.
//
// Of 600 random groups of 1 to 40 particles (4 in a cell, Poisson's ratio 0.49) with small random motion 0, 93, 269 (of
// those under half a cell), 588 fly apart within some hundred steps of courant 0.5, 0.65, 0.8, 1.0 without it; with it
// none up to 0.7 (1200 groups, 9 in a cell, ratio 0.3 too), 1 at 0.8. With one particle in a cell, which fills as much
// as four, 2 to 4 of 600 do at 0.7.
#pragma once

#include <algorithm>

namespace tailrun::mpm {

struct SparsePatches {
  // What `courant` (step/solver.hpp) may be with it.
  static constexpr double longest_courant = 0.7;

  double cell = 0.0;  // m2; 0: nothing is softened
  bool active() const { return cell > 0.0; }

  // Share of the volumetric increment, for a patch with `volume` (m2) of particles whose places have the variance
  // `spread` (cells squared, of both directions together; 2/3 where they fill it).
  double share(double volume, double spread) const {
    constexpr double softest = 0.3, full_volume = 3.0, full_spread = 0.62;  // cells; JUDGE, by the figures above
    const double filled = volume * spread / (full_volume * cell * full_spread);
    return filled < 1.0 ? softest + (1.0 - softest) * filled : 1.0;
  }
};

}  // namespace tailrun::mpm

// Soil that lies about in single particles, made softer, so that steps need not be shorter for it than for bodies.
//
// A few particles alone on their nodes breathe faster than any wave in a body (step/lone_particle.hpp): in the plane,
// AFLIP's B-splines bear steps of h / c in bodies, half of it in one particle. What breathes is their volume. So where
// the patches of volumetric_projection.hpp are sparse, only a share of the projected volumetric increment goes into
// stress and volume, as if the soil there had that share of its stiffness: the step that a lone particle bears grows by
// 1 / sqrt(share). Sparse is what fills little of a patch or lies close together in it. Where a patch is filled evenly,
// by three quarters or more, nothing changes; flow and friction are nobody's elastic volume, and drops are stress-free.
//
// Of 200 random groups of 1 to 12 particles in up to 2.5 x 2.5 cells 52, 107, 189, 200 fly apart with courant 0.65,
// 0.7, 0.8, 1.0 without it and 0, 1, 1, 31 with it (lone_particle_test prints this; of 600 groups 0, 1, 4 at 0.65, 0.7,
// 0.8).
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

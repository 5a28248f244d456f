// Steps so long that single particles swing ever more.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/material/principal_stress.hpp"
#include "mpm_stage/scene/request_checks.hpp"
#include "mpm_stage/scene/scene_checks.hpp"
#include "mpm_stage/step/lone_particle.hpp"
#include "mpm_stage/transfer/sparse_patches.hpp"

namespace tailrun::mpm {

namespace {

// Soil that bears no tension opens instead of swinging: asked of its law, with a cohesion of 1 Pa where it has any.
bool bears_tension(const Material& m, const MaterialConstants& k) {
  if (!m.law->returned) return true;
  constexpr double trial = 1e6;  // Pa
  return m.law->returned(k, has_cohesion(m) ? 1.0 : 0.0, {trial, trial, trial}).s1 > 0.0;
}

}  // namespace

// Splines carry particles that are alone on their nodes between others. Soil whose changes of volume are averaged is
// softened there (transfer/sparse_patches.hpp); of other soil a lone particle of density rho breathes with M = 2
// (lambda + mu) (step/lone_particle.hpp).
void warn_of_long_steps(const CaseNode& root, const Scene& scene) {
  const SolverOptions& o = scene.solver;
  const double always = longest_courant<QuadraticShape>(2);
  if (scene.dimension != 2 || o.shape != ShapeName::quadratic || o.fields.count < 2 || o.courant <= always) return;
  const double wave = fastest_wave(scene);
  std::vector<MaterialConstants> constants;
  std::vector<bool> tension;
  for (const Material& m : scene.materials) {
    constants.push_back(constants_of(m, scene.cell_size));
    tension.push_back(bears_tension(m, constants.back()));
  }
  double longest = std::numeric_limits<double>::infinity();
  std::string swings;
  for (std::size_t p = 0; p < scene.particles.count(); ++p) {
    const auto material = static_cast<std::size_t>(scene.particles.material_id[p]);
    const Material& m = scene.materials[material];
    double bears = std::numeric_limits<double>::infinity();
    if (m.average_volumetric_strain && o.volumetric_average) {
      bears = SparsePatches::longest_courant;
    } else if (tension[material]) {
      const MaterialConstants& k = constants[material];
      bears = wave * always * std::sqrt(scene.particles.mass[p] / scene.particles.volume[p] / (k.lambda + k.mu));
    }
    if (bears < longest) {
      longest = bears;
      swings = m.name;
    }
  }
  if (o.courant > longest)
    root.warn("time", fmt::format("courant is {}: steps longer than {:.2g} let single particles of '{}' between other "
                                  "soil swing ever more, until they tear the run apart",
                                  o.courant, longest, swings));
}

}  // namespace tailrun::mpm

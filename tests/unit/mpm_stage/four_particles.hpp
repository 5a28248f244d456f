// A particle file's content for tests that read scenes: four particles on a square of 1 m, all of the first material.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/particles.hpp"

namespace tailrun {

inline ParticleSet four_particles(std::vector<std::string> materials) {
  ParticleSet p;
  p.material_names = std::move(materials);
  p.position = {0.25, 0.25, 0, 0.75, 0.25, 0, 0.25, 0.75, 0, 0.75, 0.75, 0};
  p.velocity.assign(12, 0.0);
  p.mass.assign(4, 500.0);
  p.volume.assign(4, 0.25);
  p.effective_stress.assign(16, 0.0);
  p.pore_pressure.assign(4, 0.0);
  p.material_id.assign(4, 0);
  return p;
}

}  // namespace tailrun

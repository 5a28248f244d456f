// mpm.json: a scene with its particles, terrain, walls, ponds and materials.
#include "mpm_stage/scene/scene.hpp"

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(mpm_scene, "mpm.json", path) {
  const tailrun::CaseFile file(path);
  const auto scene = tailrun::mpm::read_scene(file, {});
  for (const double x : scene.particles.position) tailrun::fuzz::require(std::isfinite(x), "a position is not finite");
  for (const double m : scene.particles.mass) tailrun::fuzz::require(m > 0.0, "a mass is not positive");
}

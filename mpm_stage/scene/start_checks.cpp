// Velocities and stresses at the start that no soil has.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mpm_stage/scene/scene_checks.hpp"

namespace tailrun::mpm {

namespace {

constexpr double fastest_slide = 100.0;  // m/s: the fastest rock avalanches
constexpr double impossible = 1000.0;    // m/s

// Key of the particles, for messages.
const char* particles_key(const Scene& scene) {
  return scene.inputs.empty() ? "particles" : "particles_file";
}

void check_particles(const CaseNode& root, const Scene& scene) {
  const ParticleSet& set = scene.particles;
  std::vector<double> modulus;  // Pa, of waves
  for (const auto& material : scene.materials)
    modulus.push_back(constants_of(material, scene.cell_size).wave_modulus());
  std::size_t fast = 0, fastest = 0, beyond_waves = 0, worst = 0;
  double most = 0.0, most_ratio = 0.0, wave_there = 0.0;
  for (std::size_t p = 0; p < set.count(); ++p) {
    const double* v = &set.velocity[3 * p];
    const double speed = std::hypot(v[0], v[1], v[2]);
    const double wave = std::sqrt(modulus[static_cast<std::size_t>(set.material_id[p])] * set.volume[p] / set.mass[p]);
    fast += speed > fastest_slide ? 1 : 0;
    beyond_waves += speed > wave ? 1 : 0;
    if (speed > most) {
      most = speed;
      fastest = p;
    }
    if (speed > most_ratio * wave) {
      most_ratio = speed / wave;
      wave_there = wave;
      worst = p;
    }
  }
  const auto where = [&](std::size_t p) {
    return fmt::format("'{}' at {}", scene.materials[static_cast<std::size_t>(set.material_id[p])].name,
                       place_text(&set.position[3 * p], set.dimension));
  };
  if (fast > 0) {
    const std::string found = fmt::format("{} of {} particles start faster than {:g} m/s, up to {:.4g} m/s ({})", fast,
                                          set.count(), fastest_slide, most, where(fastest));
    if (most > impossible)
      root.fail(particles_key(scene),
                fmt::format("{}, but at most {:g} m/s are allowed; velocities are in m/s", found, impossible));
    root.warn(particles_key(scene), found + ", which no slide is: is the unit right?");
  }
  if (beyond_waves > 0)
    root.warn(
        particles_key(scene),
        fmt::format("{} of {} particles start faster than waves in their material, up to {:.4g} m/s where these "
                    "have {:.3g} m/s ({}): what they hit is crushed to a fraction of its volume. Are velocity and "
                    "stiffness (youngs_modulus, bulk_modulus) in the right units?",
                    beyond_waves, set.count(), most_ratio * wave_there, wave_there, where(worst)));
}

void check_speeds(const CaseNode& root, const Scene& scene) {
  for (std::size_t b = 0; b < scene.walls.bodies.size(); ++b) {
    double most = 0.0;
    for (const auto& v : scene.walls.bodies[b].velocity) most = std::max(most, std::hypot(v[0], v[1], v[2]));
    if (most <= fastest_slide) continue;
    const std::string key = fmt::format("bodies/{}", b);
    const std::string found = fmt::format("'{}' moves with up to {:.4g} m/s", scene.walls.bodies[b].name, most);
    if (most > impossible)
      root.fail(key, fmt::format("{}, but at most {:g} m/s are allowed; velocities are in m/s", found, impossible));
    root.warn(key, found + ": is the unit right?");
  }
}

// Stresses given to particles made here, against the weight of all soil above the lowest (those of a file are judged by
// common/plausible_state.hpp).
void check_stresses(const CaseNode& root, const Scene& scene) {
  const ParticleSet& set = scene.particles;
  const double gravity = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  if (!scene.inputs.empty() || !(gravity > 0.0)) return;
  double low = set.position[1], high = low, most = 0.0, density = 0.0;
  std::size_t place = 0;
  for (std::size_t p = 0; p < set.count(); ++p) {
    low = std::min(low, set.position[3 * p + 1]);
    high = std::max(high, set.position[3 * p + 1]);
    density = std::max(density, set.mass[p] / set.volume[p]);
    const double stress = std::fabs(set.effective_stress[static_cast<std::size_t>(set.components()) * p + 1]);
    if (stress <= most) continue;
    most = stress;
    place = p;
  }
  constexpr double most_weights = 10.0;
  const double height = std::max(high - low, scene.cell_size), weight = density * gravity * height;
  if (most > most_weights * weight)
    root.warn("particles",
              fmt::format("vertical stresses of up to {:.3g} Pa are given (at {}), but {:.3g} m of this soil "
                          "weigh {:.3g} Pa: is the surface of stress a height y of the scene, in m?",
                          most, place_text(&set.position[3 * place], set.dimension), height, weight));
}

}  // namespace

void check_start(const CaseNode& root, const Scene& scene) {
  check_particles(root, scene);
  check_speeds(root, scene);
  check_stresses(root, scene);
}

}  // namespace tailrun::mpm

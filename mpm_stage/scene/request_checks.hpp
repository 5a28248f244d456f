// Whether a scene asks for more than a machine has, judged before the start with the numbers: particles, steps, frames,
// rows, bytes.
#pragma once

#include <array>
#include <filesystem>

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

// Particles along each side of a shape (made here) that this machine's memory does not hold. `node` is the shape.
// Throws InputError.
void check_particle_count(const CaseNode& node, const std::array<double, 3>& along, int dimension);

// m/s, of waves in the fastest material, as the solver has it at the start.
double fastest_wave(const Scene& scene);

// Grid, steps, frames and rows of a whole scene. A run that may stop at rest is judged by its first quarter of an hour.
// Throws InputError.
void check_requests(const CaseNode& root, const Scene& scene);

// Frames that the disk of the folder for the results does not hold; those of an earlier run that are there will be
// replaced. Of a new run: one that goes on has written its own. Throws InputError.
void check_space(const Scene& scene, const std::filesystem::path& folder);

}  // namespace tailrun::mpm

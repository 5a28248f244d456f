// What a scene says that can be computed but is no soil on this earth: most often a number in another unit or a sign.
// What nothing sensible can follow from is an InputError, what is only unlikely a warning (common/warnings.hpp); each
// names its key, what was found and where. They need the whole scene, so they come when all else has been read.
#pragma once

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

// Its size (common/plausible_surroundings.hpp; scenes without gravity are patches and waves), and its direction: over
// 60 degrees off -y is a warning, for y is up; an error where neither ground nor walls stand against it
// (gravity_checks.cpp).
void check_gravity(const CaseNode& root, const Scene& scene);

// Velocities of particles and bodies at the start: beyond 1000 m/s an error; beyond 100 m/s, or faster than the waves
// in the material, a warning. Stresses of particles made here: beyond ten times the weight of the soil
// (start_checks.cpp).
void check_start(const CaseNode& root, const Scene& scene);

// Bodies that never come near soil, ground or the domain; histories of velocity that go on long after the run, begin
// after it or are shorter than a step; two bodies in one place (body_checks.cpp).
void check_bodies(const CaseNode& root, const Scene& scene);

// Two terrain lines on each other: an error where they differ, else a warning (doubled_ground.cpp).
void check_doubled_ground(const CaseNode& root, const Scene& scene);

// Entries of "materials": common/plausible_material.hpp, and keys that only mpm.json has (material_checks.cpp).
void check_materials(const CaseNode& root, const Scene& scene);

// Whether any strength is left to the material without pressure: a number, a table, a ratio, or what the particles
// bring.
bool has_cohesion(const Material& material);

// Speeds and shares that end a run, put soil to sleep or switch off a guard (threshold_checks.cpp).
void check_thresholds(const CaseNode& root, const Scene& scene);

// Steps that lone particles do not bear where several velocity fields meet (long_steps.cpp).
void warn_of_long_steps(const CaseNode& root, const Scene& scene);

// Ponds off the scene, without any water, or far over all soil (pond_checks.cpp).
void check_ponds(const CaseNode& root, const Scene& scene);

}  // namespace tailrun::mpm

// Whether the places that "output" of mpm.json names (points, sections, toe, footprint) lie where there is soil: each
// that does not is a warning, for its numbers say nothing.
#pragma once

#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

void check_output_places(const CaseNode& root, const Scene& scene);

}  // namespace tailrun::mpm

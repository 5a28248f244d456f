// What laws of soil that yields share: keys and constants of cohesion, tension cut-off, growth of strength with the
// rate of shear, and softening. How strength then changes as the soil flows is in strength.hpp.
#pragma once

#include "common/case_file.hpp"
#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

// Keys "cohesion" (and what its laws need), "tension_cutoff" and "rate".
void read_strength(const CaseNode& node, Material& m);
// Key "softening", after the others. Returns its node, so that a law may read more there; none: it does not soften.
std::optional<CaseNode> read_softening(const CaseNode& node, Material& m);

// `cell_size` (m) regularises softening.
void set_strength_constants(const Material& m, double cell_size, MaterialConstants& k);

}  // namespace tailrun::mpm

// What every law with linear elasticity under it shares: keys of the elastic constants and of the pore pressure, Lame's
// constants.
#pragma once

#include "common/case_file.hpp"
#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

// `pore_pressure` is the law's default for the key of that name: "total", "frozen" or "undrained".
void read_elastic_solid(const CaseNode& node, const char* pore_pressure, Material& m);

void set_elastic_constants(const Material& m, MaterialConstants& k);

}  // namespace tailrun::mpm

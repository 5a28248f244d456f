// Which freedoms are fixed, tied or free in each stage.
#pragma once

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// Freedoms of the geostatic stage (base fixed, sides on rollers) and of shaking (base and sides released).
// Consolidation holds the displacements of the geostatic stage and the pore pressures of the shaking.
Freedoms geostatic_freedoms(const Model& model);
Freedoms consolidation_freedoms(const Model& model);
Freedoms shaking_freedoms(const Model& model);

// Throws InputError when nothing at all holds the model along x or along y in a stage, or, where there is water, when
// nothing holds its pressure although /geostatic/seepage has to find it.
void check_support(const Model& model);

}  // namespace tailrun::fem

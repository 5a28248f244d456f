// What the mesh decides over: stiffness, strengths, held pressures and loads against the weight of soil and water of
// the model's own height.
#pragma once

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// common/plausible_stiffness.hpp for each material, with the height (m) from the lowest to the highest of its own
// elements: a soft layer over deep rock carries no more than itself.
// `root` is the whole case file, which build_model knows no more.
void check_own_weight(const CaseNode& root, const Model& model);

// Warnings, with their reasons; nothing without gravity:
//   held pressure   nowhere over 2e-3 of that of water as deep as the model is high, and not 0: in kPa. Samples of a
//                   few decimetres have few hundreds of pascals, so the bound goes with the height
//                   over 1e7 Pa (a kilometre of water) and a hundred times that of the model's height: multiplied once
//                   too often. Back pressures of small samples stay below the first
//   pressure and traction of a load that does not change with time
//                   above 0 and under both 100 Pa and a thousandth of the soil's weight: in kPa
//                   over 1e7 Pa and a hundred times the soil's weight: multiplied once too often
void check_pressures(const Model& model);

}  // namespace tailrun::fem

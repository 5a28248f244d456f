// Void ratios, porosities, relative densities and saturations in per cent. All three programs and the element tests
// have some of them.
#pragma once

#include "common/case_file.hpp"

namespace tailrun {

// Errors, each with the fraction that is likely meant. Asked before the keys are read, whose ranges know no reason:
//   relative_density, porosity, saturation
//                    over 1.2 and up to 120: shares. A number beyond that is left to the key's own range
//   e_min, e_max, void_ratio
//                    over 15: 94 % of voids, more than mud has that has just settled (10) and sand by far (1.2)
void check_voids(const CaseNode& node);

}  // namespace tailrun

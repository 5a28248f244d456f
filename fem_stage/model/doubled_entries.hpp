// Entries that are there twice, so that what they do is done twice.
#pragma once

#include <vector>

#include "common/case_file.hpp"
#include "fem_stage/model/boundary_options.hpp"

namespace tailrun::fem {

// Warns of a load that another one is equal to (place, value, history, and a stage in which both act): both act. It can
// be meant, so it is no error. `root` is the whole case file, `duration` (s) that of the shaking.
void warn_of_doubled_loads(const CaseNode& root, const std::vector<LoadOptions>& loads, double duration);

// Throws InputError where a line has free-field dashpots twice: no soil takes in waves twice.
void refuse_doubled_dashpots(const CaseNode& root, const std::vector<FreeFieldSide>& sides);

// Throws InputError where a line's pore pressure is held at two values (drained lines: at 0): nodes have one.
void refuse_two_held_pressures(const CaseNode& root, const std::vector<HeldPressure>& held);

}  // namespace tailrun::fem

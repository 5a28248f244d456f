// Loads that never act.
#pragma once

#include <vector>

#include "common/case_file.hpp"
#include "fem_stage/model/boundary_options.hpp"

namespace tailrun::fem {

// Warns of a load whose history stays at nothing during the shaking (`duration`, `step`: s), because its ramp begins
// after the end, say: the run would be one without it. `root` is the whole case file.
void warn_of_idle_loads(const CaseNode& root, const std::vector<LoadOptions>& loads, double duration, double step);

}  // namespace tailrun::fem

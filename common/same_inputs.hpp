// Whether a run that goes on from a checkpoint has the input that it began with.
#pragma once

#include "common/provenance.hpp"

namespace tailrun {

// Case files count by what they say, in its order (free names are numbered by it), everything else by its bytes. Throws
// InputError that names the input, and in a case file the first place that differs. Warns of another version.
void check_same_inputs(const Hdf5Reader& checkpoint, const Provenance& now);

}  // namespace tailrun

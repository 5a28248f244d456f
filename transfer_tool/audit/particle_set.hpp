// Step 5 of the hand-over: what is written.
#pragma once

#include "common/particles.hpp"
#include "transfer_tool/assign/rules.hpp"
#include "transfer_tool/map/map_state.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace tailrun::transfer {

// Everything of the earlier steps in the particles file's own layout; `terrain` and notes are added by the caller.
ParticleSet particle_set(const Snapshot& snapshot, const SamplePoints& points, const PointState& state,
                         const Assignment& assignment);

}  // namespace tailrun::transfer

// The ponds of the finite elements as the particles get them: from where to where there is water below the level.
#pragma once

#include <vector>

#include "common/ponded_water.hpp"
#include "common/snapshot.hpp"

namespace tailrun::transfer {

// A pond reaches to both sides from the lines that it stands on, in the deformed geometry: as far as the ground stays
// below its level, and over the shore up to the highest point of what holds it back, so that the water follows soil
// that slides into it and not soil that slides away on the other side. Where no shore is, it goes on beyond the mesh.
// Ponds that touch no ground below their level are left out with a warning.
std::vector<PondedReach> pond_reaches(const Snapshot& snapshot);

// A phreatic line above the free surface of kept elements is water that stands there. Without a pond of that level its
// weight is missing: throws InputError where that is more than 1 m, warns from 0.1 m. `only_warn`: where it is not
// known yet which elements will be kept.
void check_standing_water(const Snapshot& snapshot, const std::vector<bool>& kept,
                          const std::vector<PondedReach>& ponds, bool only_warn = false);

}  // namespace tailrun::transfer

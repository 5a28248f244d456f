// Two ways to turn one value per element into a field inside a region; map_state.hpp says what they are good for.
#pragma once

#include <vector>

#include "common/snapshot.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace tailrun::transfer {

// (points, columns); `field` is (elements, columns).
std::vector<double> nodal_recovery(const Snapshot& snapshot, const SamplePoints& points,
                                   const std::vector<double>& field, std::size_t columns);

// Gradients are taken in the undeformed geometry, about each element's undeformed centre of area.
std::vector<double> linear_recovery(const Snapshot& snapshot, const SamplePoints& points,
                                    const std::vector<double>& field, std::size_t columns);

}  // namespace tailrun::transfer

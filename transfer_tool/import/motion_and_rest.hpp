// What another program's tables say beside weight and water, which common/plausible_state.hpp judges: the horizontal
// stress at rest, and how fast and how far the nodes have moved.
#pragma once

#include "common/case_file.hpp"
#include "common/snapshot.hpp"

namespace tailrun::transfer {

// Of the state before the shaking, stresses in Pa. K = sigma'_xx / sigma'_yy, sums over the elements whose vertical
// stress is a compression; soils at rest have 0.3 to 1, stiff clay up to 3.
//   sigma'_xx a tension in more than half of them   its sign. An error where the sum is one of more than a tenth of the
//                                                   vertical's, else (elastic bodies have tensions about zero) a
//                                                   warning
//   K over 50       columns of different units (error)
//   K over 5, under 0.1
//                   a warning
//   sigma'_xx, not sigma'_yy, is what the weight above leaves beside the pore pressure
//                   exchanged columns: sigma'_yy under 0.8 of it, sigma'_xx nearer to it and more than 1.3 times
//                   sigma'_yy (warning). In overconsolidated soil sigma'_yy is the one that fits
// Of the nodes:
//   velocity        over 100 m/s, which the fastest slide has not: a warning; over 1000 m/s: an error. From 1 s on,
//                   over 5 m/s and 300 times the largest displacement a second, which no earthquake has (60): mm/s, or
//                   displacements of another unit or time (warning). km/h for m/s are not to be told from a fast flow
//   displacement    over the diagonal of the mesh: an error; over half of the height: mm or cm for m (warning)
// Throws InputError; `root` is the whole case file.
void check_rest_and_motion(const CaseNode& root, const Snapshot& snapshot);

}  // namespace tailrun::transfer

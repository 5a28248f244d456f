// What an energy ledger that is closed may still say against a run: energy that the scheme gave, or that nothing
// explains.
#pragma once

#include <string>
#include <vector>

#include "mpm_stage/output/ledger.hpp"

namespace tailrun::mpm {

// Sentences for warnings, from the first and the last row and what was turned over between them (J):
//   crowding   more than all that gravitation, motion and elasticity of the start set free: soil gives up its crowding
//              as it shears (scheme/crowding_relief), and where weak soil or a fluid lies in a pool that shearing comes
//              of it again. Right is at most what it set free as it sank into itself, which is a part of that
//   residual   over a twentieth of the turnover, either way: integration in time and the projection of the volumetric
//              stress take some per cent where soil flows and splashes, and nothing tells what more of it does. Only
//              where soil `flows`: of the little that settling turns over shares say nothing
// None where both are small beside the start's energy, or where transfer and impacts are not known (NaN).
std::vector<std::string> energy_remarks(const LedgerRow& first, const LedgerRow& last, double turnover, bool flows);

}  // namespace tailrun::mpm

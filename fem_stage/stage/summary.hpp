// summary.json of fem_stage: what was computed, how long each phase took, and how good it is.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "fem_stage/stage/consolidate.hpp"
#include "fem_stage/stage/geostatic.hpp"
#include "fem_stage/stage/shake.hpp"

namespace tailrun::fem {

nlohmann::ordered_json mesh_summary(const Mesh& mesh);
nlohmann::ordered_json geostatic_summary(const GeostaticReport& report);
nlohmann::ordered_json shake_summary(const Model& model, const Motion& motion, const ShakeReport& report);
nlohmann::ordered_json consolidation_summary(const ConsolidationReport& report);

}  // namespace tailrun::fem

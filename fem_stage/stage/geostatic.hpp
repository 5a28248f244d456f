// The geostatic stage: water pressure from steady seepage, elastic gravity with K0, what the soil cannot carry of
// it spread to its surroundings, the switch to the plastic models, and settling until the dam is at rest under its own
// weight.
#pragma once

#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

struct GeostaticReport {
  double elastic_residual = 0.0;   // residual force after the elastic solution, of the weight
  double yielding_residual = 0.0;  // after spreading what the soil cannot carry
  int yielding_iterations = 0;
  double switch_residual = 0.0;  // after the switch to the plastic models
  double final_residual = 0.0;   // after settling
  double settlement = 0.0;       // m, largest displacement of the settling
  double largest_tension = 0.0;  // Pa, largest in-plane principal effective tension at the end
  double seconds = 0.0;
};

// Returns the state at rest (displacement zero). Throws ComputationError when the final residual exceeds the case's
// tolerance, naming the worst node, after the fields have been kept in `state`.
GeostaticReport run_geostatic(const Model& model, MaterialPoints& points, State& state);

}  // namespace tailrun::fem

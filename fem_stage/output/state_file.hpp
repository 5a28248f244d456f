// The model's state as a snapshot file (common/snapshot.hpp), with everything that is needed to go on from it in the
// group /tailrun/fem_restart.
#pragma once

#include <filesystem>

#include "common/snapshot.hpp"
#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// Excess pore pressure ratio r_u of each element: mean excess of its nodes / max(sigma'_v0, 5 kPa), 0 where the
// geostatic pore pressure is below 300 Pa (not saturated).
std::vector<double> excess_pore_pressure_ratio(const Model& model, const State& state);

// sqrt((exx - eyy)^2 + gxy^2) at the element's point, from the displacement since the start of shaking.
std::vector<double> shear_strain(const Model& model, const State& state);

// `base_velocity` (m/s) is what turns velocities relative to a rigid base into absolute ones (zero for a compliant
// base, whose own mean velocity is found from the state), `base_acceleration` likewise.
Snapshot make_snapshot(const Model& model, const State& state, double rigid_velocity, double rigid_acceleration,
                       double rigid_displacement);

void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const MaterialPoints& points, double rigid_velocity, double rigid_acceleration,
                 double rigid_displacement);

// Throws InputError when the file was made with another mesh (numbers of nodes or elements, coordinates) or other
// materials.
void read_state(const std::filesystem::path& path, const Model& model, State& state, MaterialPoints& points);

}  // namespace tailrun::fem

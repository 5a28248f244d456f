// What a checkpoint must be before a run goes on from it. The solver trusts its state: a particle outside of its block
// would be added to nodes that are not there.
#pragma once

#include "common/hdf5_file.hpp"
#include "mpm_stage/checkpoint/checkpoint.hpp"

namespace tailrun::mpm {

// A whole number kept as an attribute of `object`, from 0 to 2^53. Throws InputError.
long whole_attribute(const Hdf5Reader& file, const std::string& object, const std::string& name);

// All of these throw InputError with the dataset. Particles against the input's own, `like` (in the order of the
// input): masses, materials and identities are the same, and who is missing has been removed.
template <int Dim>
void check_particles(const Hdf5Reader& file, const Particles<Dim>& particles, const Particles<Dim>& like,
                     const std::vector<std::int32_t>& removed);

// Blocks in range, in their order and each once; every particle in its block but for the drift since the last sort.
template <int Dim>
void check_blocks(const Hdf5Reader& file, const SolverState<Dim>& state, const Particles<Dim>& particles,
                  const Scene& scene, const std::array<double, Dim>& origin);

// Arrays by block, node and material have the lengths that the solver expects; times and counts make sense.
template <int Dim>
void check_state(const Hdf5Reader& file, const SolverState<Dim>& state, const Scene& scene);

// Rows begin at 0, ascend, end no later than the run's time, and are as many in each series.
void check_series(const Hdf5Reader& file, const RunState& run, const Scene& scene);

}  // namespace tailrun::mpm

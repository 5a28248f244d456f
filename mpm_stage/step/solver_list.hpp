// The solvers that there are: one for each dimension, shape function and transfer, and for momentum and forces apart on
// the nodes (split) or as one. Each is seconds of compiler time, so each is instantiated (TAILRUN_MPM_SOLVER
// in one_solver.hpp) in a file that compiles beside the others, and only programs that choose among all of them
// (all_solvers.cpp) are linked to all.
#pragma once

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

// As make_solver; defined in one_solver.hpp.
template <int Dim, class Shape, bool Split, TransferName Transfer>
std::unique_ptr<Solver<Dim>> make_one_solver(const SolverOptions& options, double cell_size,
                                             std::array<double, Dim> origin, Particles<Dim> particles,
                                             const std::vector<Material>& materials, const Terrain& terrain,
                                             const Walls<Dim>& walls);

// make_solver of both dimensions, for the file that defines it.
#define TAILRUN_MPM_MAKE_SOLVER(Dim)                                                                                   \
  template std::unique_ptr<Solver<Dim>> make_solver<Dim>(const SolverOptions&, double, std::array<double, Dim>,        \
                                                         Particles<Dim>, const std::vector<Material>&, const Terrain&, \
                                                         const Walls<Dim>&);

}  // namespace tailrun::mpm

// Compiles solvers of the list (solver_list.hpp): what the files solver_*.cpp consist of.
#pragma once

#include "mpm_stage/step/explicit_solver.hpp"
#include "mpm_stage/step/solver_list.hpp"

namespace tailrun::mpm {

template <int Dim, class Shape, bool Split, TransferName Transfer>
std::unique_ptr<Solver<Dim>> make_one_solver(const SolverOptions& options, double cell_size,
                                             std::array<double, Dim> origin, Particles<Dim> particles,
                                             const std::vector<Material>& materials, const Terrain& terrain,
                                             const Walls<Dim>& walls) {
  return std::make_unique<ExplicitSolver<Dim, Shape, Split, Transfer>>(options, cell_size, origin, std::move(particles),
                                                                       materials, terrain, walls);
}

// The solver of one combination, and those of a dimension and shape function.
#define TAILRUN_MPM_SOLVER(Dim, Shape, Split, Transfer)                                                    \
  template std::unique_ptr<Solver<Dim>> make_one_solver<Dim, Shape, Split, TransferName::Transfer>(        \
      const SolverOptions&, double, std::array<double, Dim>, Particles<Dim>, const std::vector<Material>&, \
      const Terrain&, const Walls<Dim>&);
#define TAILRUN_MPM_SOLVERS(Dim, Shape)       \
  TAILRUN_MPM_SOLVER(Dim, Shape, true, flip)  \
  TAILRUN_MPM_SOLVER(Dim, Shape, true, aflip) \
  TAILRUN_MPM_SOLVER(Dim, Shape, false, fmpm) \
  TAILRUN_MPM_SOLVER(Dim, Shape, true, apic)  \
  TAILRUN_MPM_SOLVER(Dim, Shape, false, apic)

}  // namespace tailrun::mpm

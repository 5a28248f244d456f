// The explicit solvers in 2-D with quadratic shape functions but for the one in solver_2d_quadratic_aflip.cpp.
#include "mpm_stage/step/one_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_SOLVER(2, QuadraticShape, true, flip)
TAILRUN_MPM_SOLVER(2, QuadraticShape, false, fmpm)
TAILRUN_MPM_SOLVER(2, QuadraticShape, true, apic)
TAILRUN_MPM_SOLVER(2, QuadraticShape, false, apic)

}  // namespace tailrun::mpm

// The explicit solvers in 2-D with linear shape functions; a file of its own so that they compile side by side.
#include "mpm_stage/step/one_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_SOLVERS(2, LinearShape)

}  // namespace tailrun::mpm

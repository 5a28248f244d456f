// The explicit solvers in 3-D with linear shape functions; a file of its own so that they compile side by side.
#include "mpm_stage/step/one_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_SOLVERS(3, LinearShape)

}  // namespace tailrun::mpm

// The explicit solvers in 2-D with cubic shape functions; a file of its own so that they compile side by side.
#include "mpm_stage/step/one_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_SOLVERS(2, CubicShape)

}  // namespace tailrun::mpm

// The explicit solver that dams' runouts take when their case asks for no other: 2-D, quadratic B-splines, AFLIP.
#include "mpm_stage/step/one_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_SOLVER(2, QuadraticShape, true, aflip)

}  // namespace tailrun::mpm

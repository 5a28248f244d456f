// The explicit solver in 3-D with gimp shape functions; a file of its own so that they compile side by side.
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/explicit_solver.hpp"

namespace tailrun::mpm {

TAILRUN_MPM_INSTANTIATE(3, GimpShape)

}  // namespace tailrun::mpm

// make_solver of programs that are linked to the one solver that dams' runouts take, which is ready a minute and a half
// of two cores before all the others.
#include <stdexcept>

#include "mpm_stage/step/solver_list.hpp"

namespace tailrun::mpm {

bool has_solver(int dimension, const SolverOptions& options) {
  return dimension == 2 && options.shape == ShapeName::quadratic && options.transfer == TransferName::aflip;
}

template <int Dim>
std::unique_ptr<Solver<Dim>> make_solver(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                                         Particles<Dim> particles, const std::vector<Material>& materials,
                                         const Terrain& terrain, const Walls<Dim>& walls) {
  if constexpr (Dim == 2)
    if (has_solver(Dim, options))
      return make_one_solver<2, QuadraticShape, true, TransferName::aflip>(
          options, cell_size, origin, std::move(particles), materials, terrain, walls);
  throw std::logic_error("this program has no such solver");
}

TAILRUN_MPM_MAKE_SOLVER(2)
TAILRUN_MPM_MAKE_SOLVER(3)

}  // namespace tailrun::mpm

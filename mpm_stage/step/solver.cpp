#include "mpm_stage/step/solver.hpp"

#include <stdexcept>

#include "mpm_stage/grid/shape_functions.hpp"

namespace tailrun::mpm {

// Defined in explicit_solver.hpp, compiled in solver_<dimension>_<shape>.cpp.
template <int Dim, class Shape>
std::unique_ptr<Solver<Dim>> make_solver_of_shape(const SolverOptions& options, double cell_size,
                                                  std::array<double, Dim> origin, Particles<Dim> particles,
                                                  const std::vector<Material>& materials, const Terrain& terrain,
                                                  const Walls<Dim>& walls);

template <int Dim>
std::unique_ptr<Solver<Dim>> make_solver(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                                         Particles<Dim> particles, const std::vector<Material>& materials,
                                         const Terrain& terrain, const Walls<Dim>& walls) {
  switch (options.shape) {
    case ShapeName::linear:
      return make_solver_of_shape<Dim, LinearShape>(options, cell_size, origin, std::move(particles), materials,
                                                    terrain, walls);
    case ShapeName::quadratic:
      return make_solver_of_shape<Dim, QuadraticShape>(options, cell_size, origin, std::move(particles), materials,
                                                       terrain, walls);
    case ShapeName::cubic:
      return make_solver_of_shape<Dim, CubicShape>(options, cell_size, origin, std::move(particles), materials, terrain,
                                                   walls);
    case ShapeName::gimp:
      return make_solver_of_shape<Dim, GimpShape>(options, cell_size, origin, std::move(particles), materials, terrain,
                                                  walls);
  }
  throw std::logic_error("unknown shape function");
}

template std::unique_ptr<Solver<2>> make_solver<2>(const SolverOptions&, double, std::array<double, 2>, Particles<2>,
                                                   const std::vector<Material>&, const Terrain&, const Walls<2>&);
template std::unique_ptr<Solver<3>> make_solver<3>(const SolverOptions&, double, std::array<double, 3>, Particles<3>,
                                                   const std::vector<Material>&, const Terrain&, const Walls<3>&);

}  // namespace tailrun::mpm

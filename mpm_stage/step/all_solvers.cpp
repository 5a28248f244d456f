// make_solver of programs that are linked to every solver.
#include <stdexcept>

#include "mpm_stage/step/solver_list.hpp"

namespace tailrun::mpm {

namespace {

template <int Dim, class Shape>
std::unique_ptr<Solver<Dim>> of_shape(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                                      Particles<Dim> particles, const std::vector<Material>& materials,
                                      const Terrain& terrain, const Walls<Dim>& walls) {
  const auto make = [&]<bool Split, TransferName Transfer>() {
    return make_one_solver<Dim, Shape, Split, Transfer>(options, cell_size, origin, std::move(particles), materials,
                                                        terrain, walls);
  };
  switch (options.transfer) {
    case TransferName::flip:
      return make.template operator()<true, TransferName::flip>();
    case TransferName::aflip:
      return make.template operator()<true, TransferName::aflip>();
    case TransferName::fmpm:
      return make.template operator()<false, TransferName::fmpm>();
    case TransferName::apic:
      break;
  }
  return options.local_damping > 0.0 ? make.template operator()<true, TransferName::apic>()
                                     : make.template operator()<false, TransferName::apic>();
}

}  // namespace

bool has_solver(int, const SolverOptions&) {
  return true;
}

template <int Dim>
std::unique_ptr<Solver<Dim>> make_solver(const SolverOptions& options, double cell_size, std::array<double, Dim> origin,
                                         Particles<Dim> particles, const std::vector<Material>& materials,
                                         const Terrain& terrain, const Walls<Dim>& walls) {
  const auto make = [&]<class Shape>() {
    return of_shape<Dim, Shape>(options, cell_size, origin, std::move(particles), materials, terrain, walls);
  };
  switch (options.shape) {
    case ShapeName::linear:
      return make.template operator()<LinearShape>();
    case ShapeName::quadratic:
      return make.template operator()<QuadraticShape>();
    case ShapeName::cubic:
      return make.template operator()<CubicShape>();
    case ShapeName::gimp:
      return make.template operator()<GimpShape>();
  }
  throw std::logic_error("unknown shape function");
}

TAILRUN_MPM_MAKE_SOLVER(2)
TAILRUN_MPM_MAKE_SOLVER(3)

}  // namespace tailrun::mpm

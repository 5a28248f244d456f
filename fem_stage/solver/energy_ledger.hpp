// Where the energy went (J): external work against kinetic energy, work done on the skeleton, on the water, in the
// hourglass modes, in damping and in the dashpots. The residual is what the time integration and the iteration's
// tolerance leave.
#pragma once

#include <span>

#include "fem_stage/solver/element_forces.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

struct EnergyLedger {
  double external_work = 0.0;   // gravity, held reactions, base input
  double kinetic_energy = 0.0;  // now
  double skeleton_work = 0.0;   // integral of effective stress over strain
  double fluid_work = 0.0;      // integral of -pore pressure over volumetric strain: stored in and lost by the water
  double hourglass_work = 0.0;  // done on the hourglass modes
  double damping_work = 0.0;    // stiffness proportional damping
  double dashpot_work = 0.0;

  double residual() const;  // external work minus all others
  double largest() const;   // scale for the residual
};

// The state and forces as they were before a step; makes the ledger's increments once it is accepted.
class EnergyRecorder {
 public:
  void before(const State& state, std::span<const double> load);
  void after(const Model& model, const State& state, const ElementForces& forces, const Newmark& newmark,
             EnergyLedger& ledger) const;

 private:
  std::vector<double> velocity_, stress_, pressure_, load_;
};

}  // namespace tailrun::fem

#include "fem_stage/solver/energy_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/element_mean.hpp"
#include "fem_stage/solver/averaged_mass.hpp"

namespace tailrun::fem {

double EnergyLedger::residual() const {
  return external_work - kinetic_energy - skeleton_work - fluid_work - hourglass_work - damping_work - dashpot_work;
}

double EnergyLedger::largest() const {
  return std::max({std::abs(external_work), kinetic_energy, std::abs(skeleton_work), std::abs(fluid_work), damping_work,
                   dashpot_work});
}

void EnergyRecorder::before(const State& state, std::span<const double> load) {
  velocity_ = state.velocity;
  stress_ = state.stress;
  pressure_ = state.pressure;
  load_.assign(load.begin(), load.end());
}

void EnergyRecorder::after(const Model& model, const State& state, const ElementForces& forces, const Newmark& newmark,
                           EnergyLedger& ledger) const {
  const auto increment = newmark.last_increment();
  const auto load = newmark.last_load();
  double external = 0.0, kinetic = 0.0;
  for (std::size_t i = 0; i < 2 * model.nodes(); ++i) {
    external += (0.5 * (load_[i] + load[i]) + state.held_force[i]) * increment[i];
    kinetic += 0.5 * model.nodal_mass[i / 2] * state.velocity[i] * state.velocity[i];
  }
  ledger.external_work += external;
  if (model.options->averaged_mass) kinetic += averaged_kinetic_difference(model, state.velocity);
  ledger.kinetic_energy = kinetic;
  for (const auto& dashpot : newmark.dashpots()) {
    const std::size_t i = 2 * static_cast<std::size_t>(dashpot.node) + static_cast<std::size_t>(dashpot.freedom);
    ledger.dashpot_work += dashpot.coefficient * 0.5 * (velocity_[i] + state.velocity[i]) * increment[i];
  }
  const auto strain = forces.strain_increment();
  double skeleton = 0.0, fluid = 0.0, damping = 0.0;
  for (std::size_t e = 0; e < model.count(); ++e) {
    const double volume = forces.elements().volume[e], *d = &strain[3 * e], *s0 = &stress_[4 * e],
                 *s1 = &state.stress[4 * e];
    skeleton += 0.5 * volume * ((s0[0] + s1[0]) * d[0] + (s0[1] + s1[1]) * d[1] + (s0[3] + s1[3]) * d[2]);
    const double before = element_mean(model.mesh.quads, pressure_, e);
    const double now = element_mean(model.mesh.quads, state.pressure, e);
    const double p = 0.5 * (model.pressure_in_stress(e, before) + model.pressure_in_stress(e, now));
    fluid -= volume * p * (d[0] + d[1]);
    damping += forces.damping_power(e, state.velocity);
  }
  ledger.skeleton_work += skeleton;
  ledger.fluid_work += fluid;
  ledger.damping_work += damping * newmark.last_step();
  const auto hourglass = forces.hourglass_work();
  ledger.hourglass_work = std::accumulate(hourglass.begin(), hourglass.end(), 0.0);
}

}  // namespace tailrun::fem

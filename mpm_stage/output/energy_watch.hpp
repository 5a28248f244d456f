// When the energy has to be looked at between two rows of the ledger.
//
// A whole look passes over all particles; every `steps` steps it costs a hundredth of them. What each step reports for
// nothing, the kinetic energy and the work done, tells the rest: since the last look their sum can have grown by what
// was elastic then, by outside work, and by what gravity gave, at most |g| sqrt(2 M E) dt in a step (M the mass, E the
// kinetic energy). More than that, by half of what is allowed, calls for a look at once.
#pragma once

#include <algorithm>
#include <cmath>

#include "mpm_stage/output/ledger.hpp"

namespace tailrun::mpm {

class EnergyWatch {
 public:
  static constexpr int steps = 32;

  // J, what motion holds and has done.
  static double spent(const StepReport& report, const WorkDone& w) {
    return report.kinetic_energy + w.plastic + w.friction + w.contact + w.damping + w.removed - w.external -
           w.pore_pressure - w.crowding;
  }

  // After `row`, measured after the step `report`: `weight` is |g| sqrt(M), `growth` what energy may grow by, J.
  void looked(const StepReport& report, const LedgerRow& row, double weight, double growth) {
    since_ = 0;
    weight_ = weight;
    allowed_ = spent(report, row.work) + row.elastic + 0.5 * growth;
  }
  // Whether this step calls for a look.
  bool due(const StepReport& report, const WorkDone& work) {
    allowed_ += weight_ * std::sqrt(2.0 * report.kinetic_energy) * report.dt;
    return ++since_ >= steps || spent(report, work) > allowed_;
  }

 private:
  double weight_ = 0.0, allowed_ = 0.0;
  int since_ = 0;
};

}  // namespace tailrun::mpm

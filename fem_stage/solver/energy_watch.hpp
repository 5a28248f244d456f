// Watches whether the energy ledger stays closed, and what hourglass modes take of it. Energy that comes from nowhere,
// or rows of elements that fold into each other, are an instability, and the result after it is worth nothing; energy
// that is lost is what the time integration damps. A warning and no end of the run: the snapshots before it are good,
// and strongly damped steps lose energy on purpose.
#pragma once

#include <optional>
#include <string>

#include "fem_stage/solver/energy_ledger.hpp"

namespace tailrun::fem {

class EnergyWatch {
 public:
  static constexpr double accepted = 0.01;            // residual over the largest entry of the ledger
  static constexpr double accepted_hourglass = 0.02;  // twice what sound meshes of the shipped cases have

  void observe(const EnergyLedger& ledger, double time);
  // s: from when on the ledger has been open, or the hourglass modes' share too large, until now.
  std::optional<double> open_since() const { return open_since_; }
  std::optional<double> hourglass_since() const { return hourglass_since_; }
  void restore(std::optional<double> open_since, std::optional<double> hourglass_since) {
    open_since_ = open_since;
    hourglass_since_ = hourglass_since;
  }
  // Empty when all is well. Names the elements whose hourglass modes took most work.
  std::string warning(const Model& model, const EnergyLedger& ledger, std::span<const double> hourglass_work) const;

 private:
  std::optional<double> open_since_, hourglass_since_;
};

}  // namespace tailrun::fem

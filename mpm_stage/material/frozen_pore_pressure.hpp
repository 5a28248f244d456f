// Pore pressure that stays as it was handed over ("frozen") while the soil's skeleton is in compression.
//
// Where soil opens, it cannot stay: a pressure that never falls would drive the opening particle like a gas without
// end. Water does not follow an opening void, so what the return to the yield surface takes off a tensile trial mean
// stress (apex, tension cut-off, dilation) is taken from the pore pressure instead, until none is left: the total mean
// stress follows its elastic trial down to that of dry soil at its tension limit. What is lost so does not come back.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

// Remembers a run of particles before its stress update, and lowers its pore pressures after it.
template <int Dim>
class FrozenPorePressure {
 public:
  // `trace` (1) as update_stress takes it.
  FrozenPorePressure(const MaterialConstants& k, Particles<Dim>& P, std::size_t begin, std::size_t end,
                     const double* trace)
      : P_(P), begin_(begin), end_(end), active_(k.pore_pressure == PorePressure::frozen) {
    if (!active_) return;
    trial_mean().resize(std::max(trial_mean().size(), end - begin));
    volume().resize(trial_mean().size());
    for (std::size_t p = begin; p < end; ++p) {
      trial_mean()[p - begin] = mean(p) + k.bulk * trace[p - begin];
      volume()[p - begin] = P.volume[p];
    }
  }

  // Returns the work that the water's pressure did on the particles' expansion, J.
  double release() {
    double work = 0.0;
    if (!active_) return work;
    for (std::size_t p = begin_; p < end_; ++p) {
      double& u = P_.pore_pressure[p];
      work += u * (P_.volume[p] - volume()[p - begin_]);
      u = std::max(std::min(u, 0.0), u - std::max(0.0, trial_mean()[p - begin_] - mean(p)));
    }
    return work;
  }

 private:
  double mean(std::size_t p) const { return (P_.stress[0][p] + P_.stress[1][p] + P_.stress[2][p]) * (1.0 / 3.0); }
  // Per thread and kept, so that no step allocates.
  static std::vector<double>& trial_mean() {
    thread_local std::vector<double> values;
    return values;
  }
  static std::vector<double>& volume() {
    thread_local std::vector<double> values;
    return values;
  }

  Particles<Dim>& P_;
  std::size_t begin_, end_;
  bool active_;
};

}  // namespace tailrun::mpm

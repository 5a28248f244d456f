// Explicit steps of the u-p system: central differences for the displacement with the lumped mass, and a pore pressure
// that follows the volume of the same half step with the lumped storage (Zienkiewicz & Shiomi 1984, the explicit
// scheme; the pressure stabilisation needs a matrix and is left out),
//
//   v+ = v + dt/2 a,  u' = u + dt v+,  p' = p + dt S^-1 (f_p - H p - Q^T v+),  a' = M^-1 (f - f_int(u') + Q p' - C v+)
//
// Displacement and pressure leap over each other, so that undrained soil acts as one with the bulk modulus K + K_f/n
// and no energy is made. Stable below 2 over the largest frequency of an element with that modulus.
#pragma once

#include <vector>

#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {

class CentralDifferences {
 public:
  CentralDifferences(const Model& model, const Freedoms& freedoms, std::vector<Dashpot> dashpots, LoadFunction load);

  // Advances by dt in equal steps no longer than 0.9 of the critical one.
  StepResult advance(State& state, MaterialPoints& points, ElementForces& forces, double dt);
  // s: from the elements' largest eigenvalues with undrained stiffness and from seepage (bounds the assembled ones).
  double critical_step(const ElementForces& forces) const;
  const SolverCounts& counts() const { return counts_; }

 private:
  StepResult step(State& state, MaterialPoints& points, ElementForces& forces, double dt);
  void add_volume_rate(const ElementForces& forces, std::span<const double> velocity, std::span<double> rate) const;

  const Model& model_;
  std::vector<Dashpot> dashpots_;
  LoadFunction load_;
  Freedoms::Equations equations_;
  std::vector<double> inertia_;  // kg or m3/Pa, per equation
  std::vector<double> damping_;  // N s/m, per equation
  std::vector<double> flow_;     // m3/s, (N): H p - f_p at the start of the step
  std::vector<double> zero_, residual_, force_, increment_, half_velocity_;
  double critical_ = 0.0;
  long until_check_ = 0;
  bool started_ = false;
  SolverCounts counts_;
};

}  // namespace tailrun::fem

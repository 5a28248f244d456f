// One implicit step of the u-p system: Newmark (1959) for the displacement (GN22), the trapezoidal family with theta
// for the pore pressure (GN11), both equations enforced at t + dt. With theta = gamma this is OpenSees' Newmark on its
// velocity-like pressure. The Newton matrix uses the elastic moduli of the last commit, is factorised rarely, and
// Anderson acceleration makes up for its age.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem_stage/solver/anderson.hpp"
#include "fem_stage/solver/element_forces.hpp"
#include "fem_stage/solver/symmetric_system.hpp"

namespace tailrun::fem {

struct NewmarkOptions {
  double gamma = 0.6, beta = 0.3025, theta = 0.6;
  double tolerance = 1e-4;  // residual force per thickness (2-norm over the free equations), of the model's weight
  int max_iterations = 30;
  int refactor_above = 6;
  int acceleration_depth = 6;
};

// External nodal forces at a time: adds to `force` (N, (N, 2)).
using LoadFunction = std::function<void(double time, std::span<double> force)>;

// Dashpot on one freedom: force -coefficient * velocity.
struct Dashpot {
  std::int64_t node;
  Freedom freedom;
  double coefficient;  // N s/m
};

struct StepResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;  // fraction of the weight
  std::string reason;     // when not converged: the worst freedom, or the material point that failed
};

struct SolverCounts {
  long steps = 0, iterations = 0, factorisations = 0, solves = 0, halvings = 0, material_substeps = 0;
  double assembly_seconds = 0.0, factorisation_seconds = 0.0, solve_seconds = 0.0, element_seconds = 0.0;
};

// The matrix in use, by what it was made of.
struct MatrixMemory {
  double step = 0.0;   // s, dt of the matrix; 0 = none
  double scale = 0.0;  // Pa/m: unit of the pressure unknown; 0 until the first matrix
  int last_iterations = 0;
  MatrixBasis basis;
};

class Newmark {
 public:
  Newmark(const Model& model, const Freedoms& freedoms, NewmarkOptions options, std::vector<Dashpot> dashpots,
          LoadFunction load);

  // Tries to advance the state by dt. On success everything is committed; otherwise `state` and the points are as
  // before.
  StepResult step(State& state, MaterialPoints& points, ElementForces& forces, double dt);

  const SolverCounts& counts() const { return counts_; }
  SolverCounts& counts() { return counts_; }
  const Freedoms::Equations& equations() const { return equations_; }
  void forget_matrix() { memory_.step = 0.0; }
  // What a run that goes on needs to have the same matrix again. `forces` come back as they are.
  const MatrixMemory& memory() const { return memory_; }
  void restore(const MatrixMemory& memory, const SolverCounts& counts, ElementForces& forces);
  // External force (N, (N, 2)) and element residual (N, 3) of the last accepted step, for the ledger.
  std::span<const double> last_load() const { return load_force_; }
  std::span<const double> last_increment() const { return increment_; }
  double last_step() const { return last_step_; }  // s
  const std::vector<Dashpot>& dashpots() const { return dashpots_; }

 private:
  void factorise(const ElementForces& forces, double dt);
  std::string worst_freedom(std::span<const double> residual) const;

  const Model& model_;
  NewmarkOptions options_;
  std::vector<Dashpot> dashpots_;
  LoadFunction load_;
  Freedoms::Equations equations_;
  SymmetricSystem system_;
  std::vector<double> thickness_;  // m, per equation: what residuals count over
  std::unique_ptr<Anderson> anderson_;
  MatrixMemory memory_;
  double last_step_ = 0.0;
  SolverCounts counts_;
  std::vector<double> inertia_difference_;  // N, (N, 2), only with averaged mass
  std::vector<double> increment_, velocity_, acceleration_, pressure_, pressure_rate_, element_residual_, load_force_,
      right_;
};

}  // namespace tailrun::fem

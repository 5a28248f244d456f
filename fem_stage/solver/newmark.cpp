#include "fem_stage/solver/newmark.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.hpp"
#include "fem_stage/solver/averaged_mass.hpp"

namespace tailrun::fem {
namespace {

class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
  ~Timer() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

Newmark::Newmark(const Model& model, const Freedoms& freedoms, NewmarkOptions options, std::vector<Dashpot> dashpots,
                 LoadFunction load)
    : model_(model),
      options_(options),
      dashpots_(std::move(dashpots)),
      load_(std::move(load)),
      equations_(freedoms.number(true, true)),
      system_(equations_.count, element_equations(model.mesh, equations_), 12),
      thickness_(equation_thickness(model, equations_)) {
  const std::size_t nodes = model.nodes();
  for (auto* array : {&increment_, &velocity_, &acceleration_, &load_force_}) array->assign(2 * nodes, 0.0);
  pressure_.assign(nodes, 0.0);
  pressure_rate_.assign(nodes, 0.0);
  element_residual_.assign(3 * nodes, 0.0);
  right_.assign(static_cast<std::size_t>(equations_.count), 0.0);
}

void Newmark::factorise(const ElementForces& forces, double dt) {
  const double c1 = options_.gamma / (options_.beta * dt);
  const double mass_factor = 1.0 / (options_.beta * dt * dt);
  const double stiffness_factor = 1.0 + c1 * forces.damping();
  {
    const Timer timer(counts_.assembly_seconds);
    const auto assemble = [&](double scale) {
      system_.clear();
      double local[144];
      for (std::size_t e = 0; e < model_.count(); ++e) {
        forces.matrix(e, mass_factor, stiffness_factor, 1.0 / (c1 * options_.theta * dt), 1.0 / c1, scale, local);
        system_.add_element(e, local);
      }
      for (const auto& dashpot : dashpots_) {
        const int equation = equations_.number[3 * static_cast<std::size_t>(dashpot.node) + dashpot.freedom];
        if (equation >= 0) system_.add_diagonal(equation, c1 * dashpot.coefficient);
      }
    };
    if (memory_.scale == 0.0) {  // balance the two blocks of the diagonal once
      assemble(1.0);
      const auto diagonal = system_.diagonal();
      double displacement = 0.0, pressure = 0.0;
      int pressures = 0;
      for (std::size_t n = 0; n < 3 * model_.nodes(); ++n) {
        const int equation = equations_.number[n];
        if (equation < 0) continue;
        (n % 3 == freedom_p ? pressure : displacement) += std::abs(diagonal[static_cast<std::size_t>(equation)]);
        pressures += n % 3 == freedom_p;
      }
      const int displacements = static_cast<int>(diagonal.size()) - pressures;
      memory_.scale = pressures > 0 && pressure > 0.0 && displacements > 0
                          ? std::sqrt(displacement / displacements / (pressure / pressures))
                          : 1.0;
      memory_.scale = std::exp2(std::round(std::log2(memory_.scale)));
    }
    assemble(memory_.scale);
  }
  {
    const Timer timer(counts_.factorisation_seconds);
    try {
      system_.factorise();
    } catch (const SingularSystem& error) {
      throw ComputationError(fmt::format(
          "the system of equations is singular at {}: nothing there resists a change. Check the boundary conditions, "
          "that the part is attached, and that a sealed saturated part has a storage or stabilisation term",
          equations_.describe(error.equation, model_.mesh)));
    }
  }
  memory_.step = dt;
  memory_.basis = forces.matrix_basis();
  ++counts_.factorisations;
  std::vector<double> weights = system_.diagonal();
  for (double& w : weights) w = std::abs(w);
  anderson_ = std::make_unique<Anderson>(static_cast<std::size_t>(equations_.count), options_.acceleration_depth,
                                         std::move(weights));
}

std::string Newmark::worst_freedom(std::span<const double> residual) const {
  std::size_t worst = 0;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (std::abs(residual[i] * thickness_[worst]) > std::abs(residual[worst] * thickness_[i])) worst = i;
  return fmt::format("largest residual {:.3g} N per metre of thickness at {}", residual[worst] / thickness_[worst],
                     equations_.describe(static_cast<int>(worst), model_.mesh));
}

void Newmark::restore(const MatrixMemory& memory, const SolverCounts& counts, ElementForces& forces) {
  memory_ = memory;
  if (memory.step > 0.0) {
    const MatrixBasis now = forces.matrix_basis();
    forces.use_matrix_basis(memory.basis);
    factorise(forces, memory.step);
    forces.use_matrix_basis(now);
  }
  counts_ = counts;
}

StepResult Newmark::step(State& state, MaterialPoints& points, ElementForces& forces, double dt) {
  const std::size_t nodes = model_.nodes();
  const double gamma = options_.gamma, beta = options_.beta, theta = options_.theta, c1 = gamma / (beta * dt);
  StepResult result;
  bool fresh = false;
  if (std::abs(memory_.step - dt) > 1e-9 * dt || memory_.last_iterations > options_.refactor_above) {
    factorise(forces, dt);
    fresh = true;
  }
  anderson_->restart();

  std::fill(load_force_.begin(), load_force_.end(), 0.0);
  load_(state.time + dt, load_force_);

  // Predictor: constant acceleration and pressure rate.
  for (std::size_t i = 0; i < 2 * nodes; ++i)
    increment_[i] = dt * state.velocity[i] + 0.5 * dt * dt * state.acceleration[i];
  for (std::size_t n = 0; n < nodes; ++n) {
    for (std::size_t i = 0; i < 2; ++i)
      if (equations_.number[3 * n + i] < 0) increment_[2 * n + i] = 0.0;
    pressure_[n] = state.pressure[n] + (equations_.number[3 * n + freedom_p] < 0 ? 0.0 : dt * state.pressure_rate[n]);
  }

  for (int iteration = 0; iteration <= options_.max_iterations; ++iteration) {
    for (std::size_t i = 0; i < 2 * nodes; ++i) {
      acceleration_[i] =
          (increment_[i] - dt * state.velocity[i]) / (beta * dt * dt) - (0.5 / beta - 1.0) * state.acceleration[i];
      velocity_[i] = state.velocity[i] + dt * ((1.0 - gamma) * state.acceleration[i] + gamma * acceleration_[i]);
    }
    for (std::size_t n = 0; n < nodes; ++n)
      pressure_rate_[n] =
          (pressure_[n] - state.pressure[n]) / (theta * dt) - (1.0 - theta) / theta * state.pressure_rate[n];

    UpdateReport report;
    {
      const Timer timer(counts_.element_seconds);
      report = forces.evaluate(points, increment_, velocity_, pressure_, pressure_rate_, element_residual_);
    }
    counts_.material_substeps += report.substeps;
    ++counts_.iterations;
    if (report.failed_point >= 0) {
      const auto c = model_.mesh.centre(static_cast<std::size_t>(report.failed_point));
      result.reason =
          fmt::format("material of element {} at ({:.4g}, {:.4g}), region '{}': {}", report.failed_point, c[0], c[1],
                      model_.mesh.region_names[static_cast<std::size_t>(
                          model_.mesh.region[static_cast<std::size_t>(report.failed_point)])],
                      report.reason);
      break;
    }

    std::fill(right_.begin(), right_.end(), 0.0);
    if (model_.options->averaged_mass) {
      inertia_difference_.assign(2 * nodes, 0.0);
      subtract_averaged_inertia(model_, acceleration_, inertia_difference_);
      for (std::size_t n = 0; n < nodes; ++n)
        for (std::size_t i = 0; i < 2; ++i)
          if (const int equation = equations_.number[3 * n + i]; equation >= 0)
            right_[static_cast<std::size_t>(equation)] += inertia_difference_[2 * n + i];
    }
    for (std::size_t n = 0; n < nodes; ++n) {
      for (std::size_t i = 0; i < 2; ++i) {
        const int equation = equations_.number[3 * n + i];
        if (equation < 0) continue;
        right_[static_cast<std::size_t>(equation)] += load_force_[2 * n + i] + state.held_force[2 * n + i] -
                                                      model_.nodal_mass[n] * acceleration_[2 * n + i] -
                                                      element_residual_[3 * n + i];
      }
      const int equation = equations_.number[3 * n + freedom_p];
      if (equation >= 0)
        right_[static_cast<std::size_t>(equation)] += memory_.scale / c1 * element_residual_[3 * n + freedom_p];
    }
    for (const auto& dashpot : dashpots_) {
      const std::size_t n = static_cast<std::size_t>(dashpot.node);
      const int equation = equations_.number[3 * n + dashpot.freedom];
      if (equation >= 0)
        right_[static_cast<std::size_t>(equation)] -= dashpot.coefficient * velocity_[2 * n + dashpot.freedom];
    }
    double squares = 0.0;
    for (std::size_t i = 0; i < right_.size(); ++i) {
      const double r = right_[i] / thickness_[i];
      squares += r * r;
    }
    result.residual = std::sqrt(squares) / model_.weight;
    result.iterations = iteration;
    if (!std::isfinite(result.residual)) {
      result.reason = "the residual is not a finite number";
      break;
    }
    if (iteration > 0 && result.residual <= options_.tolerance) {
      result.converged = true;
      break;
    }
    if (iteration == options_.max_iterations) {
      result.reason =
          fmt::format("no convergence in {} iterations: residual {:.2e} of the weight (tolerance {:.0e}), {}",
                      iteration, result.residual, options_.tolerance, worst_freedom(right_));
      break;
    }
    if (!fresh && iteration == 2 * options_.refactor_above) {
      factorise(forces, dt);
      fresh = true;
    }
    {
      const Timer timer(counts_.solve_seconds);
      system_.solve(right_, right_);
      ++counts_.solves;
      anderson_->accelerate(right_);
    }
    for (std::size_t n = 0; n < nodes; ++n) {
      for (std::size_t i = 0; i < 2; ++i) {
        const int equation = equations_.number[3 * n + i];
        if (equation >= 0) increment_[2 * n + i] += right_[static_cast<std::size_t>(equation)];
      }
      const int equation = equations_.number[3 * n + freedom_p];
      if (equation >= 0) pressure_[n] += memory_.scale * right_[static_cast<std::size_t>(equation)];
    }
  }
  memory_.last_iterations = fresh ? 0 : result.iterations;
  if (!result.converged) {
    memory_.step = 0.0;
    return result;
  }
  ++counts_.steps;
  last_step_ = dt;
  state.time += dt;
  for (std::size_t i = 0; i < 2 * nodes; ++i) state.displacement[i] += increment_[i];
  state.velocity = velocity_;
  state.acceleration = acceleration_;
  state.pressure = pressure_;
  state.pressure_rate = pressure_rate_;
  forces.commit(points, state, increment_);
  return result;
}

}  // namespace tailrun::fem

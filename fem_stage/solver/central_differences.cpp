#include "fem_stage/solver/central_differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tailrun::fem {
namespace {

constexpr double safety = 0.9;
constexpr long steps_between_checks = 200;

// Largest eigenvalue of M^-1 K, both of one element, K 8 x 8 with the pore water's share, by power iteration.
double largest_eigenvalue(const double stiffness[64], const double mass[8]) {
  double v[8] = {1, -0.3, -0.8, 0.5, 0.9, -0.2, -1.1, 0.4}, value = 0.0;
  for (int iteration = 0; iteration < 40; ++iteration) {
    double w[8], norm = 0.0;
    for (int i = 0; i < 8; ++i) {
      w[i] = 0.0;
      for (int j = 0; j < 8; ++j) w[i] += stiffness[8 * i + j] * v[j];
      w[i] /= mass[i];
      norm = std::max(norm, std::abs(w[i]));
    }
    value = norm;
    for (int i = 0; i < 8; ++i) v[i] = w[i] / norm;
  }
  return value;
}

}  // namespace

CentralDifferences::CentralDifferences(const Model& model, const Freedoms& freedoms, std::vector<Dashpot> dashpots,
                                       LoadFunction load)
    : model_(model), dashpots_(std::move(dashpots)), load_(std::move(load)), equations_(freedoms.number(true, true)) {
  inertia_.assign(static_cast<std::size_t>(equations_.count), 0.0);
  damping_ = inertia_;
  const auto at = [&](std::size_t freedom) { return equations_.number[freedom]; };
  for (std::size_t i = 0; i < model.mesh.quads.size(); ++i) {
    const std::size_t node = static_cast<std::size_t>(model.mesh.quads[i]);
    if (at(3 * node + freedom_p) >= 0)
      inertia_[static_cast<std::size_t>(at(3 * node + freedom_p))] +=
          model.storage[i / 4] * model.elements.nodal_volume[i];
  }
  for (std::size_t n = 0; n < model.nodes(); ++n)
    for (std::size_t i = 0; i < 2; ++i)
      if (at(3 * n + i) >= 0) inertia_[static_cast<std::size_t>(at(3 * n + i))] += model.nodal_mass[n];
  for (const auto& dashpot : dashpots_)
    if (const int equation = at(3 * static_cast<std::size_t>(dashpot.node) + dashpot.freedom); equation >= 0)
      damping_[static_cast<std::size_t>(equation)] += dashpot.coefficient;
  residual_.assign(3 * model.nodes(), 0.0);
  for (auto* array : {&force_, &increment_, &half_velocity_}) array->assign(2 * model.nodes(), 0.0);
  for (auto* array : {&flow_, &zero_}) array->assign(model.nodes(), 0.0);
}

double CentralDifferences::critical_step(const ElementForces& forces) const {
  double shortest = 1e30;
  for (std::size_t e = 0; e < model_.count(); ++e) {
    double local[144], stiffness[64], mass[8], seepage = 0.0;
    forces.matrix(e, 0.0, 1.0, 0.0, -1.0, 1.0, local);
    const double storage = 0.25 * model_.storage[e] * forces.elements().volume[e];  // of each node
    for (int i = 0; i < 8; ++i) {
      const int a = 3 * (i / 2) + i % 2;
      mass[i] = model_.density[e] * model_.elements.nodal_volume[4 * e + static_cast<std::size_t>(i / 2)];
      for (int j = 0; j < 8; ++j) {
        const int b = 3 * (j / 2) + j % 2;
        double water = 0.0;
        for (int k = 0; k < 4; ++k) water += local[12 * a + 3 * k + 2] * local[12 * b + 3 * k + 2];
        bool saturated = false;
        for (std::size_t k = 0; k < 4; ++k)
          saturated = saturated ||
                      equations_.number[3 * static_cast<std::size_t>(model_.mesh.quads[4 * e + k]) + freedom_p] >= 0;
        stiffness[8 * i + j] = local[12 * a + b] + (saturated ? water / storage : 0.0);
      }
    }
    for (int k = 0; k < 4; ++k) seepage += local[12 * (3 * k + 2) + 3 * k + 2];
    shortest = std::min(shortest, 2.0 / std::sqrt(largest_eigenvalue(stiffness, mass)));
    if (seepage > 0.0) shortest = std::min(shortest, 2.0 * storage / seepage);
  }
  return shortest;
}

void CentralDifferences::add_volume_rate(const ElementForces& forces, std::span<const double> velocity,
                                         std::span<double> rate) const {
  const SspQuadUp& el = forces.elements();
  for (std::size_t e = 0; e < model_.count(); ++e) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(model_.mesh.quads[4 * e + a]);
      sum += el.dndx[4 * e + a] * velocity[2 * node] + el.dndy[4 * e + a] * velocity[2 * node + 1];
    }
    for (std::size_t a = 0; a < 4; ++a)
      rate[static_cast<std::size_t>(model_.mesh.quads[4 * e + a])] += 0.25 * el.volume[e] * sum;
  }
}

StepResult CentralDifferences::advance(State& state, MaterialPoints& points, ElementForces& forces, double dt) {
  if (until_check_ <= 0) {
    critical_ = critical_step(forces);
    until_check_ = steps_between_checks;
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / (safety * critical_))));
  StepResult result;
  for (int i = 0; i < steps; ++i) {
    result = step(state, points, forces, dt / steps);
    if (!result.converged) return result;
  }
  until_check_ -= steps;
  return result;
}

StepResult CentralDifferences::step(State& state, MaterialPoints& points, ElementForces& forces, double dt) {
  const std::size_t nodes = model_.nodes();
  StepResult result;
  if (!started_) {  // H p - f_p of the first step: no motion, no change of the materials
    std::fill(increment_.begin(), increment_.end(), 0.0);
    forces.evaluate(points, increment_, increment_, state.pressure, zero_, residual_);
    for (std::size_t n = 0; n < nodes; ++n) flow_[n] = residual_[3 * n + freedom_p];
    started_ = true;
  }
  for (std::size_t i = 0; i < 2 * nodes; ++i) {
    half_velocity_[i] = state.velocity[i] + 0.5 * dt * state.acceleration[i];
    increment_[i] = dt * half_velocity_[i];
  }
  add_volume_rate(forces, half_velocity_, flow_);
  std::vector<double> right(inertia_.size(), 0.0);
  for (std::size_t n = 0; n < nodes; ++n)
    if (const int equation = equations_.number[3 * n + freedom_p]; equation >= 0)
      right[static_cast<std::size_t>(equation)] -= flow_[n];
  for (std::size_t n = 0; n < nodes; ++n)
    if (const int equation = equations_.number[3 * n + freedom_p]; equation >= 0)
      state.pressure[n] +=
          dt * right[static_cast<std::size_t>(equation)] / inertia_[static_cast<std::size_t>(equation)];

  const UpdateReport report = forces.evaluate(points, increment_, half_velocity_, state.pressure, zero_, residual_);
  ++counts_.iterations;
  counts_.material_substeps += report.substeps;
  if (report.failed_point >= 0) {
    result.reason = fmt::format("material of element {}: {}", report.failed_point, report.reason);
    return result;
  }
  std::fill(flow_.begin(), flow_.end(), 0.0);
  add_volume_rate(forces, half_velocity_, flow_);
  for (std::size_t n = 0; n < nodes; ++n) flow_[n] = residual_[3 * n + freedom_p] - flow_[n];

  std::fill(force_.begin(), force_.end(), 0.0);
  load_(state.time + dt, force_);
  std::fill(right.begin(), right.end(), 0.0);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i)
      if (const int equation = equations_.number[3 * n + i]; equation >= 0)
        right[static_cast<std::size_t>(equation)] +=
            force_[2 * n + i] + state.held_force[2 * n + i] - residual_[3 * n + i];
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i) {
      const int equation = equations_.number[3 * n + i];
      state.displacement[2 * n + i] += increment_[2 * n + i];
      if (equation < 0) continue;
      const auto k = static_cast<std::size_t>(equation);
      // the dashpot acts on the velocity at the end: v' = v+ + dt/2 a'
      const double a = (right[k] - damping_[k] * half_velocity_[2 * n + i]) / (inertia_[k] + 0.5 * dt * damping_[k]);
      state.acceleration[2 * n + i] = a;
      state.velocity[2 * n + i] = half_velocity_[2 * n + i] + 0.5 * dt * a;
      if (!std::isfinite(a)) {
        result.reason = fmt::format("not a finite number at {}", equations_.describe(equation, model_.mesh));
        return result;
      }
    }
  state.time += dt;
  forces.commit(points, state, increment_);
  ++counts_.steps;
  result.converged = true;
  return result;
}

}  // namespace tailrun::fem

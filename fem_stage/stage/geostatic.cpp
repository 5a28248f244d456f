#include "fem_stage/stage/geostatic.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.hpp"
#include "common/progress.hpp"
#include "common/warnings.hpp"
#include "fem_stage/boundary/phreatic_line.hpp"
#include "fem_stage/model/stage_freedoms.hpp"
#include "fem_stage/solver/anderson.hpp"
#include "fem_stage/solver/newmark.hpp"

namespace tailrun::fem {
namespace {

[[noreturn]] void fail_singular(const std::string& what, int equation, const Freedoms::Equations& equations,
                                const Mesh& mesh) {
  throw ComputationError(
      fmt::format("{}: the system is singular at {}; nothing fixes it there. Check the boundary conditions and that "
                  "every part of the mesh is attached",
                  what, equations.describe(equation, mesh)));
}

// Weight, and the loads of this stage.
std::vector<double> load_at_rest(const Model& model) {
  std::vector<double> force(2 * model.nodes(), 0.0);
  for (std::size_t n = 0; n < model.nodes(); ++n) force[2 * n + 1] = -model.nodal_mass[n] * model.options->gravity;
  for (const auto& item : model.loads)
    if (item.in_geostatic) add_load(item, 0.0, force);
  return force;
}

// H p = f_p with p held at 0 on and above the phreatic line and at what the boundaries say.
void solve_seepage(const Model& model, const Freedoms& freedoms, const ElementForces& forces, State& state) {
  const auto equations = freedoms.number(false, true);
  state.pressure = model.held_pressure;
  if (equations.count == 0) return;
  if (model.options->geostatic.seepage == Seepage::hydrostatic) {
    for (std::size_t n = 0; n < model.nodes(); ++n)
      if (equations.number[3 * n + freedom_p] >= 0)
        state.pressure[n] = model.options->fluid_density * model.options->gravity *
                            (phreatic_elevation(model.options->phreatic_line, model.mesh.x(n)) - model.mesh.y(n));
    return;
  }
  SymmetricSystem system(equations.count, element_equations(model.mesh, equations), 12);
  std::vector<double> right(static_cast<std::size_t>(equations.count), 0.0);
  double local[144];
  const double weight = model.options->fluid_density * model.options->gravity;
  for (std::size_t e = 0; e < model.count(); ++e) {
    forces.matrix(e, 0.0, 0.0, 0.0, -1.0, 1.0, local);  // the block is -flow_factor H
    system.add_element(e, local);
    for (std::size_t a = 0; a < 4; ++a) {
      const int equation = equations.number[3 * static_cast<std::size_t>(model.mesh.quads[4 * e + a]) + freedom_p];
      if (equation < 0) continue;
      right[static_cast<std::size_t>(equation)] -=
          model.permeability_y[e] * weight * model.elements.gradient_y[4 * e + a];
      for (std::size_t b = 0; b < 4; ++b)
        if (const double held = model.held_pressure[static_cast<std::size_t>(model.mesh.quads[4 * e + b])]; held != 0.0)
          right[static_cast<std::size_t>(equation)] -= local[12 * (3 * a + 2) + 3 * b + 2] * held;
    }
  }
  try {
    system.factorise();
  } catch (const SingularSystem& error) {
    fail_singular("initial water pressure", error.equation, equations, model.mesh);
  }
  system.solve(right, right);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const int equation = equations.number[3 * n + freedom_p];
    if (equation >= 0) state.pressure[n] = right[static_cast<std::size_t>(equation)];
  }
}

struct Balance {
  std::vector<double> residual;  // N, (N, 2): load - internal, at every freedom
  double free_norm = 0.0;        // of the weight, over the free freedoms
  std::size_t worst_node = 0;
};

Balance balance_at_rest(const Model& model, const Freedoms::Equations& equations, MaterialPoints& points,
                        ElementForces& forces, const State& state, const std::vector<double>& load,
                        std::span<const double> increment) {
  const std::size_t nodes = model.nodes();
  const std::vector<double> zero(2 * nodes, 0.0), zero_rate(nodes, 0.0);
  std::vector<double> element(3 * nodes);
  const UpdateReport report = forces.evaluate(points, increment, zero, state.pressure, zero_rate, element);
  if (report.failed_point >= 0) {
    const auto c = model.mesh.centre(static_cast<std::size_t>(report.failed_point));
    throw ComputationError(fmt::format("gravity: material of element {} at ({:.4g}, {:.4g}): {}", report.failed_point,
                                       c[0], c[1], report.reason));
  }
  Balance out;
  out.residual.resize(2 * nodes);
  std::vector<double> sums(static_cast<std::size_t>(equations.count), 0.0);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i) {
      out.residual[2 * n + i] = load[2 * n + i] - element[3 * n + i];
      const int equation = equations.number[3 * n + i];
      if (equation >= 0) sums[static_cast<std::size_t>(equation)] += out.residual[2 * n + i];
    }
  const auto thickness = equation_thickness(model, equations);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= thickness[i];
  double squares = 0.0, worst = -1.0;
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i) {
      const int equation = equations.number[3 * n + i];
      if (equation < 0 || std::abs(sums[static_cast<std::size_t>(equation)]) <= worst) continue;
      worst = std::abs(sums[static_cast<std::size_t>(equation)]);
      out.worst_node = n;
    }
  for (const double s : sums) squares += s * s;
  out.free_norm = std::sqrt(squares) / model.weight;
  return out;
}

// Modified Newton with the elastic matrix `system` and Anderson acceleration. Returns the displacement (m, (N, 2))
// whose balance is the one left in `balance`.
std::vector<double> spread_out_of_balance(const Model& model, const Freedoms::Equations& equations,
                                          MaterialPoints& points, ElementForces& forces, const State& state,
                                          const std::vector<double>& load, SymmetricSystem& system, Balance& balance,
                                          int& iterations) {
  constexpr int most_iterations = 400, depth = 10;
  const double wanted = 0.01 * model.options->geostatic.tolerance;
  std::vector<double> weights = system.diagonal();
  for (double& w : weights) w = std::abs(w);
  Anderson anderson(weights.size(), depth, weights);
  std::vector<double> displacement(2 * model.nodes(), 0.0), right(weights.size());
  for (iterations = 0; iterations < most_iterations; ++iterations) {
    balance = balance_at_rest(model, equations, points, forces, state, load, displacement);
    if (balance.free_norm <= wanted) return displacement;
    std::fill(right.begin(), right.end(), 0.0);
    for (std::size_t i = 0; i < displacement.size(); ++i)
      if (const int equation = equations.number[3 * (i / 2) + i % 2]; equation >= 0)
        right[static_cast<std::size_t>(equation)] += balance.residual[i];
    system.solve(right, right);
    anderson.accelerate(right);
    for (std::size_t i = 0; i < displacement.size(); ++i)
      if (const int equation = equations.number[3 * (i / 2) + i % 2]; equation >= 0)
        displacement[i] += right[static_cast<std::size_t>(equation)];
  }
  balance = balance_at_rest(model, equations, points, forces, state, load, displacement);
  return displacement;
}

}  // namespace

GeostaticReport run_geostatic(const Model& given, MaterialPoints& points, State& state) {
  const auto start = std::chrono::steady_clock::now();
  const GeostaticOptions& options = given.options->geostatic;
  GeostaticReport report;
  Model model = given;  // with the permeability of this stage
  if (options.seepage == Seepage::isotropic) {
    std::fill(model.permeability_x.begin(), model.permeability_x.end(), 1e-3);
    std::fill(model.permeability_y.begin(), model.permeability_y.end(), 1e-3);
  }
  const std::size_t nodes = model.nodes(), count = model.count();
  for (auto* array : {&state.displacement, &state.velocity, &state.acceleration, &state.held_force})
    array->assign(2 * nodes, 0.0);
  for (auto* array : {&state.pressure, &state.pressure_rate, &state.initial_pressure}) array->assign(nodes, 0.0);
  state.stress.assign(4 * count, 0.0);
  state.initial_stress = state.stress;
  state.hourglass_force.assign(2 * count, 0.0);
  state.max_pore_pressure_ratio.assign(count, 0.0);

  const Freedoms freedoms = geostatic_freedoms(model);
  ElementForces forces(model, 0.0, false);

  // 1. Water: steady seepage below the phreatic line.
  solve_seepage(model, freedoms, forces, state);

  // 2. Soil: elastic gravity in one lift; Poisson's ratio gives K0.
  const std::vector<double> poisson(model.options->materials.size(), options.K0 / (1.0 + options.K0));
  points.set_stress(state.stress);
  points.start_elastic_stage(poisson);
  forces.reset(points, state);
  const auto equations = freedoms.number(true, false);
  const auto load = load_at_rest(model);
  const std::vector<double> none(2 * nodes, 0.0);
  SymmetricSystem system(equations.count, element_equations(model.mesh, equations), 12);
  double local[144];
  for (std::size_t e = 0; e < count; ++e) {
    forces.matrix(e, 0.0, 1.0, 0.0, 0.0, 0.0, local);
    system.add_element(e, local);
  }
  try {
    system.factorise();
  } catch (const SingularSystem& error) {
    fail_singular("elastic gravity", error.equation, equations, model.mesh);
  }
  Balance balance = balance_at_rest(model, equations, points, forces, state, load, none);
  std::vector<double> right(static_cast<std::size_t>(equations.count), 0.0), gravity_displacement(2 * nodes, 0.0);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i)
      if (const int equation = equations.number[3 * n + i]; equation >= 0)
        right[static_cast<std::size_t>(equation)] += balance.residual[2 * n + i];
  system.solve(right, right);
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t i = 0; i < 2; ++i)
      if (const int equation = equations.number[3 * n + i]; equation >= 0)
        gravity_displacement[2 * n + i] = right[static_cast<std::size_t>(equation)];
  balance = balance_at_rest(model, equations, points, forces, state, load, gravity_displacement);
  forces.commit(points, state, gravity_displacement);
  report.elastic_residual = balance.free_norm;

  // 3. What that leaves of tension, and of shear beyond the strength, goes to the soil around.
  if (options.yielding) {
    points.start_yielding_stage();
    forces.reset(points, state);
    const std::vector<double> spread = spread_out_of_balance(model, equations, points, forces, state, load, system,
                                                             balance, report.yielding_iterations);
    forces.commit(points, state, spread);
    report.yielding_residual = balance.free_norm;
    if (balance.free_norm > options.tolerance) {
      const auto n = balance.worst_node;
      add_warning(
          fmt::format("/geostatic/gravity: the soil's strength does not carry its weight as it is: {:.1e} of "
                      "the weight stays out of balance, most at ({:.4g}, {:.4g})",
                      balance.free_norm, model.mesh.x(n), model.mesh.y(n)));
    }
  }

  // 4. Switch to the plastic models from the stress found.
  points.start_plastic_stage(true);
  forces.reset(points, state);
  balance = balance_at_rest(model, equations, points, forces, state, load, none);
  forces.commit(points, state, none);
  report.switch_residual = balance.free_norm;

  // 5. Settle: strongly damped implicit steps (gamma 1.5, beta 1) in which water drains freely.
  if (options.settle_time > 0.0) {
    NewmarkOptions newmark_options;
    newmark_options.gamma = newmark_options.theta = 1.5;
    newmark_options.beta = 1.0;
    newmark_options.tolerance = 0.1 * options.tolerance;
    Newmark newmark(model, freedoms, newmark_options, {}, [&](double, std::span<double> force) {
      for (std::size_t i = 0; i < 2 * nodes; ++i) force[i] += load[i];
    });
    Progress progress("settle", options.settle_time, "s");
    state.time = 0.0;
    while (state.time < options.settle_time - 1e-9) {
      const StepResult result =
          newmark.step(state, points, forces, std::min(options.settle_step, options.settle_time - state.time));
      if (!result.converged) {
        add_warning(
            fmt::format("/geostatic/settle_time: settling stopped at {:.3g} of {:g} s: {}; what is left out of balance "
                        "is final_residual_of_weight",
                        state.time, options.settle_time, result.reason));
        break;
      }
      progress.update(state.time, newmark.counts().steps);
    }
    progress.finish();
    for (const double u : state.displacement) report.settlement = std::max(report.settlement, std::abs(u));
    balance = balance_at_rest(model, equations, points, forces, state, load, none);
    forces.commit(points, state, none);
  }
  report.final_residual = balance.free_norm;

  // 6. The state at rest: what results refer to from now on.
  state.time = 0.0;
  for (auto* array : {&state.displacement, &state.velocity, &state.acceleration})
    std::fill(array->begin(), array->end(), 0.0);
  std::fill(state.pressure_rate.begin(), state.pressure_rate.end(), 0.0);
  state.initial_stress = state.stress;
  state.initial_pressure = state.pressure;
  for (std::size_t e = 0; e < count; ++e) {
    const double mean = 0.5 * (state.stress[4 * e] + state.stress[4 * e + 1]),
                 half = 0.5 * (state.stress[4 * e] - state.stress[4 * e + 1]);
    report.largest_tension = std::max(report.largest_tension, mean + std::hypot(half, state.stress[4 * e + 3]));
  }
  // Freedoms that shaking releases keep their reaction as a load.
  const auto released = shaking_freedoms(model).number(true, false);
  for (std::size_t i = 0; i < 2 * nodes; ++i) {
    const std::size_t freedom = 3 * (i / 2) + i % 2;
    if (equations.number[freedom] < 0 && released.number[freedom] >= 0) state.held_force[i] = -balance.residual[i];
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.final_residual > options.tolerance)
    throw ComputationError(
        fmt::format("gravity: the dam does not come to rest: residual force {:.2e} of the weight (accepted: {:.0e}), "
                    "largest at node {} at ({:.4g}, {:.4g}). It may not stand: check strengths there, give a longer "
                    "/geostatic/settle_time, or raise /geostatic/tolerance",
                    report.final_residual, options.tolerance, balance.worst_node, model.mesh.x(balance.worst_node),
                    model.mesh.y(balance.worst_node)));
  return report;
}

}  // namespace tailrun::fem

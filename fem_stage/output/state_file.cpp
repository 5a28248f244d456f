#include "fem_stage/output/state_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/element_mean.hpp"
#include "common/error.hpp"
#include "common/file_format.hpp"

namespace tailrun::fem {
namespace {

constexpr double saturated_above = 300.0;         // Pa of geostatic pore pressure
constexpr double smallest_vertical_stress = 5e3;  // Pa, in the denominator of r_u
const std::string restart = "/tailrun/fem_restart";

}  // namespace

std::vector<double> excess_pore_pressure_ratio(const Model& model, const State& state) {
  std::vector<double> ratio(model.count(), 0.0);
  for (std::size_t e = 0; e < model.count(); ++e) {
    const double initial = element_mean(model.mesh.quads, state.initial_pressure, e);
    if (initial < saturated_above) continue;
    const double excess = element_mean(model.mesh.quads, state.pressure, e) - initial;
    ratio[e] = excess / std::max(-state.initial_stress[4 * e + 1], smallest_vertical_stress);
  }
  return ratio;
}

std::vector<double> shear_strain(const Model& model, const State& state) {
  std::vector<double> strain(model.count());
  for (std::size_t e = 0; e < model.count(); ++e) {
    const CentreGradient now = centre_gradient(model.elements, model.mesh.quads.data(), state.displacement, e);
    strain[e] = std::hypot(now.xx - now.yy, now.xy);
  }
  return strain;
}

Snapshot make_snapshot(const Model& model, const State& state, double rigid_velocity, double rigid_acceleration,
                       double rigid_displacement) {
  const std::size_t count = model.count(), nodes = model.nodes();
  Snapshot out;
  out.time = state.time;
  out.gravity = model.options->gravity;
  out.fluid_density = model.options->fluid_density;
  out.region_names = model.mesh.region_names;
  for (const auto& [name, edges] : model.mesh.lines) {
    MeshLine line{name, {}};
    for (const auto& edge : edges) line.edges.insert(line.edges.end(), edge.begin(), edge.end());
    out.lines.push_back(std::move(line));
  }
  out.phreatic_line = model.options->phreatic_line;
  for (const auto& pond : model.options->boundaries.ponds) out.ponds.push_back({pond.level, pond.lines});
  out.position = model.mesh.position;
  out.displacement = state.displacement;
  out.velocity = state.velocity;
  out.acceleration = state.acceleration;
  for (std::size_t n = 0; n < nodes; ++n) {
    out.displacement[2 * n] += rigid_displacement;
    out.velocity[2 * n] += rigid_velocity;
    out.acceleration[2 * n] += rigid_acceleration;
  }
  for (const auto node : model.base_nodes)
    for (std::size_t i = 0; i < 2; ++i)
      out.base_velocity[i] +=
          out.velocity[2 * static_cast<std::size_t>(node) + i] / static_cast<double>(model.base_nodes.size());
  out.pore_pressure = state.pressure;
  out.excess_pore_pressure.resize(nodes);
  for (std::size_t n = 0; n < nodes; ++n) out.excess_pore_pressure[n] = state.pressure[n] - state.initial_pressure[n];
  out.quads = model.mesh.quads;
  out.region_id = model.mesh.region;
  out.thickness = model.thickness;
  out.density = model.density;
  out.porosity = model.porosity;
  out.effective_stress = state.stress;
  out.total_stress = state.stress;
  out.initial_effective_stress = state.initial_stress;
  out.initial_vertical_effective_stress.resize(count);
  out.initial_pore_pressure.resize(count);
  out.depth.resize(count);
  out.effective_stress_ratio.resize(count);
  for (std::size_t e = 0; e < count; ++e) {
    const double pressure = element_mean(model.mesh.quads, state.pressure, e);
    for (std::size_t i = 0; i < 3; ++i) out.total_stress[4 * e + i] -= model.pressure_in_stress(e, pressure);
    out.initial_pore_pressure[e] = element_mean(model.mesh.quads, state.initial_pressure, e);
    const double vertical = -state.initial_stress[4 * e + 1];
    out.initial_vertical_effective_stress[e] = vertical;
    out.effective_stress_ratio[e] = 1.0 + state.stress[4 * e + 1] / std::max(vertical, smallest_vertical_stress);
    const auto c = model.mesh.centre(e);
    out.depth[e] = ground_elevation(model.mesh, c[0]) - c[1];
  }
  out.excess_pore_pressure_ratio = excess_pore_pressure_ratio(model, state);
  out.max_excess_pore_pressure_ratio = state.max_pore_pressure_ratio;
  out.shear_strain = shear_strain(model, state);
  out.scaled_jacobian = scaled_jacobians(model.mesh, state.displacement);
  return out;
}

void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const MaterialPoints& points, double rigid_velocity, double rigid_acceleration,
                 double rigid_displacement) {
  const Snapshot snapshot = make_snapshot(model, state, rigid_velocity, rigid_acceleration, rigid_displacement);
  write_snapshot(path, snapshot, model.options->provenance, [&](Hdf5Writer& file) {
    const auto material = points.save_state();
    file.write(restart + "/material_state", std::span<const double>(material), 0, "1",
               "every internal variable of the material points");
    file.write(restart + "/hourglass_force", std::span<const double>(state.hourglass_force), 2, "N",
               "committed hourglass forces of the elements");
    file.write(restart + "/held_force", std::span<const double>(state.held_force), 2, "N",
               "reactions of freedoms released after the geostatic stage, held as loads");
    file.write(restart + "/pressure_rate", std::span<const double>(state.pressure_rate), 0, "Pa/s",
               "rate of the pore pressure");
    file.write(restart + "/initial_pressure", std::span<const double>(state.initial_pressure), 0, "Pa",
               "geostatic pore pressure of the nodes");
    if (!state.rotation.empty()) {
      file.write(restart + "/rotation", std::span<const double>(state.rotation), 0, "rad",
                 "turn of the frame that the material's stress lives in");
      file.write(restart + "/turned_hourglass_force", std::span<const double>(state.turned_hourglass_force), 2, "N",
                 "committed hourglass forces, turned with the element");
    }
    if (!state.floor_stress.empty()) {
      file.write(
          restart + "/floor_stress", std::span<const double>(state.floor_stress), 2, "Pa",
          "(xx - yy)/2 and xy of what the residual strength's floor carries, part of the effective stress, in the "
          "frame that the material's stress lives in");
      file.write(restart + "/liquefied", std::span<const double>(state.liquefied), 0, "1",
                 "1 where the soil has liquefied and its residual strength is a floor");
    }
    if (!state.softening.empty())
      file.write(restart + "/softening", std::span<const double>(state.softening), 0, "1",
                 "1 where softening is scaled by the element's height");
    if (rigid_velocity != 0.0 || rigid_acceleration != 0.0 || rigid_displacement != 0.0) {
      const double rigid[3] = {rigid_displacement, rigid_velocity, rigid_acceleration};
      file.write(restart + "/rigid_base_motion", std::span<const double>(rigid), 0, "1",
                 "displacement (m), velocity (m/s), acceleration (m/s2) of a rigid base along x, part of the nodes'");
    }
  });
}

void read_state(const std::filesystem::path& path, const Model& model, State& state, MaterialPoints& points) {
  const Snapshot snapshot = read_snapshot(path);
  const std::size_t nodes = model.nodes(), count = model.count();
  if (snapshot.nodes() != nodes || snapshot.elements() != count)
    throw InputError(fmt::format(
        "{}: made with another mesh ({} nodes, {} elements; this case has {} and {}). Run the geostatic stage again.",
        path.string(), snapshot.nodes(), snapshot.elements(), nodes, count));
  for (std::size_t i = 0; i < 2 * nodes; ++i)
    if (std::abs(snapshot.position[i] - model.mesh.position[i]) > 1e-9 * (1.0 + std::abs(model.mesh.position[i])))
      throw InputError(fmt::format("{}: made with another mesh (node {} has moved). Run the geostatic stage again.",
                                   path.string(), i / 2));
  const Hdf5Reader file(path);
  if (!file.has(restart))
    throw InputError(
        fmt::format("{}: has no restart state (group {}); it was not written by fem_stage", path.string(), restart));
  const auto material = file.doubles(restart + "/material_state");
  if (material.size() != points.save_state().size())
    throw InputError(fmt::format(
        "{}: was made with other material models or by another version of fem_stage. Run the geostatic stage again.",
        path.string()));
  points.restore_state(material);
  state.time = snapshot.time;
  state.displacement = snapshot.displacement;
  state.velocity = snapshot.velocity;
  state.acceleration = snapshot.acceleration;
  state.pressure = snapshot.pore_pressure;
  state.pressure_rate = file.doubles(restart + "/pressure_rate", nodes, 1);
  state.stress = snapshot.effective_stress;
  state.hourglass_force = file.doubles(restart + "/hourglass_force", count, 2);
  state.held_force = file.doubles(restart + "/held_force", nodes, 2);
  state.initial_stress = snapshot.initial_effective_stress;
  state.initial_pressure = file.doubles(restart + "/initial_pressure", nodes, 1);
  state.max_pore_pressure_ratio = snapshot.max_excess_pore_pressure_ratio;
  state.rotation.clear();
  state.turned_hourglass_force.clear();
  if (file.has(restart + "/rotation")) {
    state.rotation = file.doubles(restart + "/rotation", count, 1);
    state.turned_hourglass_force = file.doubles(restart + "/turned_hourglass_force", count, 2);
  }
  state.floor_stress.clear();
  state.liquefied.clear();
  if (file.has(restart + "/floor_stress")) {
    state.floor_stress = file.doubles(restart + "/floor_stress", count, 2);
    state.liquefied = file.doubles(restart + "/liquefied", count, 1);
  }
  state.softening.clear();
  if (file.has(restart + "/softening")) state.softening = file.doubles(restart + "/softening", count, 1);
  state.rigid_displacement = 0.0;
  if (file.has(restart + "/rigid_base_motion")) {
    const auto rigid = file.doubles(restart + "/rigid_base_motion", 3, 1);
    for (std::size_t n = 0; n < nodes; ++n) {
      state.displacement[2 * n] -= rigid[0];
      state.velocity[2 * n] -= rigid[1];
      state.acceleration[2 * n] -= rigid[2];
    }
    state.rigid_displacement = rigid[0];
  }
}

}  // namespace tailrun::fem

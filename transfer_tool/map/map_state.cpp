#include "transfer_tool/map/map_state.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/element_mean.hpp"
#include "common/error.hpp"
#include "transfer_tool/map/recovery.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {

std::vector<double> recovered(const Snapshot& snapshot, const SamplePoints& points, const std::vector<double>& field,
                              std::size_t columns, Recovery recovery) {
  if (recovery == Recovery::nodal) return nodal_recovery(snapshot, points, field, columns);
  if (recovery == Recovery::linear) return linear_recovery(snapshot, points, field, columns);
  std::vector<double> values(points.count() * columns);
  for (std::size_t p = 0; p < points.count(); ++p)
    for (std::size_t k = 0; k < columns; ++k)
      values[columns * p + k] = field[columns * static_cast<std::size_t>(points.element[p]) + k];
  return values;
}

std::vector<double> interpolated(const Snapshot& snapshot, const SamplePoints& points, const std::vector<double>& field,
                                 std::size_t columns, std::size_t k) {
  std::vector<double> values(points.count());
  for (std::size_t p = 0; p < points.count(); ++p) {
    const auto element = static_cast<std::size_t>(points.element[p]);
    for (std::size_t a = 0; a < 4; ++a)
      values[p] += points.node_weights[4 * p + a] *
                   field[columns * static_cast<std::size_t>(snapshot.quads[4 * element + a]) + k];
  }
  return values;
}

namespace {

// 1 for every element whose pores are under suction that its total stress does not feel (soil above the phreatic line).
std::vector<char> feels_no_suction(const Snapshot& snapshot) {
  std::vector<char> out(snapshot.elements(), 0);
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    const double mean = element_mean(snapshot.quads, snapshot.pore_pressure, e);
    const double felt = snapshot.effective_stress[4 * e + 1] - snapshot.total_stress[4 * e + 1];
    out[e] = mean < 0.0 && felt > 0.5 * mean;
  }
  return out;
}

}  // namespace

PointState map_state(const Snapshot& snapshot, const SamplePoints& points, const MapOptions& options) {
  PointState state;
  const std::size_t n = points.count();
  state.velocity.resize(2 * n);
  state.displacement.resize(2 * n);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto velocity = interpolated(snapshot, points, snapshot.velocity, 2, k);
    const auto displacement = interpolated(snapshot, points, snapshot.displacement, 2, k);
    const double base = options.remove_base_motion ? snapshot.base_velocity[k] : 0.0;
    for (std::size_t p = 0; p < n; ++p) {
      state.velocity[2 * p + k] = velocity[p] - base;
      state.displacement[2 * p + k] = displacement[p];
    }
  }
  state.effective_stress = recovered(snapshot, points, snapshot.effective_stress, 4, options.stress);
  state.pore_pressure = interpolated(snapshot, points, snapshot.pore_pressure, 1, 0);
  const auto is_free_of_suction = feels_no_suction(snapshot);
  for (std::size_t p = 0; p < n; ++p)
    if (is_free_of_suction[static_cast<std::size_t>(points.element[p])]) state.pore_pressure[p] = 0.0;
  state.initial_vertical_effective_stress =
      recovered(snapshot, points, snapshot.initial_vertical_effective_stress, 1, options.initial_stress);
  state.excess_pore_pressure_ratio = recovered(
      snapshot, points,
      options.maximum_pressure_ratio ? snapshot.max_excess_pore_pressure_ratio : snapshot.excess_pore_pressure_ratio, 1,
      options.pressure_ratio);
  state.shear_strain = recovered(snapshot, points, snapshot.shear_strain, 1, Recovery::element);
  if (!options.depth_of_point) {
    state.depth = recovered(snapshot, points, snapshot.depth, 1, Recovery::element);
    return state;
  }
  const GroundSurface surface(snapshot);
  for (std::size_t p = 0; p < n; ++p)
    state.depth.push_back(surface.depth(points.initial_position[2 * p], points.initial_position[2 * p + 1]));
  return state;
}

void take_initial_state(Snapshot& snapshot, const Snapshot& geostatic) {
  if (geostatic.quads != snapshot.quads || geostatic.position.size() != snapshot.position.size())
    throw InputError(fmt::format("the geostatic file's mesh ({} nodes, {} elements) is not the snapshot's ({}, {})",
                                 geostatic.nodes(), geostatic.elements(), snapshot.nodes(), snapshot.elements()));
  for (std::size_t i = 0; i < snapshot.position.size(); ++i)
    if (std::abs(geostatic.position[i] - snapshot.position[i]) > 1e-9 * (1.0 + std::abs(snapshot.position[i])))
      throw InputError(fmt::format("node {} of the geostatic file lies elsewhere than in the snapshot", i / 2));
  constexpr double least_stress = 5e3;  // Pa, the lower bound in r_u's denominator (common/snapshot.hpp)
  snapshot.initial_effective_stress = geostatic.effective_stress;
  for (std::size_t node = 0; node < snapshot.nodes(); ++node)
    snapshot.excess_pore_pressure[node] = snapshot.pore_pressure[node] - geostatic.pore_pressure[node];
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    const double excess = element_mean(snapshot.quads, snapshot.excess_pore_pressure, e);
    const double before = element_mean(snapshot.quads, geostatic.pore_pressure, e);
    const double vertical = -geostatic.effective_stress[4 * e + 1];
    const bool is_dry = snapshot.excess_pore_pressure_ratio[e] == 0.0;
    snapshot.initial_pore_pressure[e] = before;
    snapshot.initial_vertical_effective_stress[e] = vertical;
    if (!is_dry) snapshot.excess_pore_pressure_ratio[e] = excess / std::max(vertical, least_stress);
  }
}

}  // namespace tailrun::transfer

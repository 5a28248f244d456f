#include "transfer_tool/audit/audit.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/error.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {
namespace {

struct Integrals {
  double mass = 0.0, volume = 0.0, kinetic_energy = 0.0, pore_pressure = 0.0, speed = 0.0;
  std::array<double, 2> first_moment{}, momentum{};
  std::array<double, 4> stress{};
};

Integrals of_mesh(const Snapshot& snapshot, const std::vector<bool>& kept, std::array<double, 2> offset) {
  Integrals sum;
  const GaussRule& rule = gauss_rule(3);
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    if (!kept[e]) continue;
    const Corners initial = initial_corners(snapshot, e), deformed = deformed_corners(snapshot, e);
    const NodeWeights initial_areas = integrated_shape_functions(initial);
    const NodeWeights deformed_areas = integrated_shape_functions(deformed);
    const double deformed_area = area(deformed);
    sum.volume += deformed_area;
    for (std::size_t k = 0; k < 4; ++k) sum.stress[k] += snapshot.effective_stress[4 * e + k] * deformed_area;
    std::array<std::array<double, 2>, 4> velocity{};
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(snapshot.quads[4 * e + a]);
      const double mass = snapshot.density[e] * initial_areas[a];
      sum.mass += mass;
      sum.pore_pressure += snapshot.pore_pressure[node] * deformed_areas[a];
      for (std::size_t k = 0; k < 2; ++k) {
        velocity[a][k] = snapshot.velocity[2 * node + k] - offset[k];
        sum.first_moment[k] += mass * deformed[a][k];
        sum.momentum[k] += mass * velocity[a][k];
      }
    }
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double xi = rule.abscissa[i], eta = rule.abscissa[j];
        const NodeWeights values = shape_functions(xi, eta);
        double squared = 0.0;
        for (std::size_t k = 0; k < 2; ++k) {
          double component = 0.0;
          for (std::size_t a = 0; a < 4; ++a) component += values[a] * velocity[a][k];
          squared += component * component;
        }
        const double mass = snapshot.density[e] * rule.weight[i] * rule.weight[j] * jacobian(initial, xi, eta);
        sum.kinetic_energy += 0.5 * mass * squared;
        sum.speed += mass * std::sqrt(squared);
      }
  }
  return sum;
}

Integrals of_particles(const ParticleSet& particles) {
  Integrals sum;
  for (std::size_t p = 0; p < particles.count(); ++p) {
    const double mass = particles.mass[p], volume = particles.volume[p];
    sum.mass += mass;
    sum.volume += volume;
    sum.pore_pressure += particles.pore_pressure[p] * volume;
    for (std::size_t k = 0; k < 2; ++k) {
      const double velocity = particles.velocity[3 * p + k];
      sum.first_moment[k] += mass * particles.position[3 * p + k];
      sum.momentum[k] += mass * velocity;
      sum.kinetic_energy += 0.5 * mass * velocity * velocity;
    }
    for (std::size_t k = 0; k < 4; ++k) sum.stress[k] += particles.effective_stress[4 * p + k] * volume;
  }
  return sum;
}

}  // namespace

double AuditRow::error() const {
  return std::abs(particles - mesh) / (scale > 0.0 ? scale : 1.0);
}

Audit audit(const Snapshot& snapshot, const std::vector<bool>& kept, std::array<double, 2> velocity_offset,
            const ParticleSet& particles) {
  const Integrals mesh = of_mesh(snapshot, kept, velocity_offset), points = of_particles(particles);
  double extent = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    double low = 1e300, high = -1e300;
    for (std::size_t p = 0; p < particles.count(); ++p) {
      low = std::min(low, particles.position[3 * p + k]);
      high = std::max(high, particles.position[3 * p + k]);
    }
    extent = std::max({extent, high - low, std::abs(low), std::abs(high)});
  }
  Audit result;
  const auto add = [&](const char* quantity, const char* unit, double a, double b, double scale, bool conserved) {
    result.rows.push_back({quantity, unit, a, b, scale, conserved});
  };
  bool is_inverted = false;
  for (std::size_t e = 0; e < snapshot.elements(); ++e) {
    if (kept[e])
      is_inverted |= scaled_jacobian(deformed_corners(snapshot, e)) <= 0.0;
    else
      result.excluded_mass += snapshot.density[e] * snapshot.thickness[e] * area(initial_corners(snapshot, e));
  }
  add("mass", "kg/m", mesh.mass, points.mass, mesh.mass, true);
  add("volume", "m3/m", mesh.volume, points.volume, mesh.volume, !is_inverted);
  const char* centres[] = {"centre of mass x", "centre of mass y"};
  const char* momenta[] = {"momentum x", "momentum y"};
  for (std::size_t k = 0; k < 2; ++k)
    add(centres[k], "m", mesh.first_moment[k] / mesh.mass, points.first_moment[k] / points.mass, extent, true);
  for (std::size_t k = 0; k < 2; ++k) add(momenta[k], "kg/s", mesh.momentum[k], points.momentum[k], mesh.speed, true);
  add("kinetic energy", "J/m", mesh.kinetic_energy, points.kinetic_energy, mesh.kinetic_energy, false);
  const char* stresses[] = {"sum sigma'_xx V", "sum sigma'_yy V", "sum sigma'_zz V", "sum sigma'_xy V"};
  double largest = 0.0;
  for (const double component : mesh.stress) largest = std::max(largest, std::abs(component));
  for (std::size_t k = 0; k < 4; ++k) add(stresses[k], "N", mesh.stress[k], points.stress[k], largest, false);
  add("sum p V", "N", mesh.pore_pressure, points.pore_pressure, std::abs(mesh.pore_pressure), false);

  result.materials = particles.material_names;
  result.count.assign(result.materials.size(), 0);
  result.mass.assign(result.materials.size(), 0.0);
  result.mean_strength.assign(result.materials.size(), 0.0);
  for (std::size_t p = 0; p < particles.count(); ++p) {
    const auto material = static_cast<std::size_t>(particles.material_id[p]);
    ++result.count[material];
    result.mass[material] += particles.mass[p];
    result.mean_strength[material] += particles.residual_strength[p];
  }
  for (std::size_t m = 0; m < result.materials.size(); ++m)
    if (result.count[m]) result.mean_strength[m] /= static_cast<double>(result.count[m]);
  return result;
}

void require_conserved(const Audit& result, double tolerance) {
  for (const auto& row : result.rows)
    if (row.conserved && !(row.error() <= tolerance))
      throw ComputationError(fmt::format("the hand-over does not conserve {}: mesh {:.15g} {}, particles {:.15g}",
                                         row.quantity, row.mesh, row.unit, row.particles));
}

std::string audit_table(const Audit& result) {
  std::string text =
      fmt::format("{:<18} {:>6} {:>20} {:>20} {:>12}\n", "quantity", "unit", "mesh", "particles", "rel. change");
  for (const auto& row : result.rows)
    text += fmt::format("{:<18} {:>6} {:>20.12g} {:>20.12g} {:>12.2e}{}\n", row.quantity, row.unit, row.mesh,
                        row.particles, row.error(), row.conserved ? "  conserved" : "");
  const double total = std::accumulate(result.mass.begin(), result.mass.end(), 0.0);
  text += fmt::format("\n{:<18} {:>10} {:>14} {:>8} {:>16}\n", "material", "particles", "mass kg/m", "share",
                      "mean s_R kPa");
  for (std::size_t m = 0; m < result.materials.size(); ++m)
    text += fmt::format("{:<18} {:>10} {:>14.6g} {:>7.2f}% {:>16}\n", result.materials[m], result.count[m],
                        result.mass[m], 100.0 * result.mass[m] / total,
                        result.mean_strength[m] > 0.0 ? fmt::format("{:.3f}", result.mean_strength[m] / 1e3) : "-");
  return text;
}

nlohmann::ordered_json audit_json(const Audit& result) {
  nlohmann::ordered_json json;
  for (const auto& row : result.rows)
    json["integrals"].push_back({{"quantity", row.quantity},
                                 {"unit", row.unit},
                                 {"mesh", row.mesh},
                                 {"particles", row.particles},
                                 {"relative_change", row.error()},
                                 {"conserved", row.conserved}});
  for (std::size_t m = 0; m < result.materials.size(); ++m)
    json["materials"].push_back({{"material", result.materials[m]},
                                 {"particles", result.count[m]},
                                 {"mass_kg_per_m", result.mass[m]},
                                 {"mean_residual_strength_Pa", result.mean_strength[m]}});
  json["mass_of_elements_left_out_kg"] = result.excluded_mass;
  return json;
}

}  // namespace tailrun::transfer

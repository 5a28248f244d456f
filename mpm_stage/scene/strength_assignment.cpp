// The cohesion of each particle, from its material's law.
#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

double interpolated(const std::vector<double>& table, double x) {
  if (x <= table[0]) return table[1];
  for (std::size_t i = 2; i < table.size(); i += 2)
    if (x <= table[i])
      return table[i - 1] + (table[i + 1] - table[i - 1]) * (x - table[i - 2]) / (table[i] - table[i - 2]);
  return table.back();
}

}  // namespace

std::vector<double> assign_cohesion(const CaseFile& file, const std::vector<Material>& materials,
                                    ParticleSet& particles) {
  std::vector<double> cohesion(particles.count(), 0.0);
  const auto need = [&](const std::vector<double>& values, const std::string& material, const std::string& field) {
    if (values.empty())
      throw InputError(fmt::format("{}: /materials/{}/cohesion asks for {}, which the particles do not have",
                                   file.path().string(), material, field));
  };
  for (std::size_t p = 0; p < particles.count(); ++p) {
    const Material& m = materials[static_cast<std::size_t>(particles.material_id[p])];
    double c = m.cohesion;
    if (m.cohesion_from_particles) {
      need(particles.residual_strength, m.name, "residual_strength");
      c = particles.residual_strength[p];
      if (!(c > 0.0))
        throw InputError(
            fmt::format("{}: /materials/{}/cohesion is 'from_particles', but particle {} has a residual strength of {} "
                        "Pa (must be > 0)",
                        file.path().string(), m.name, p, c));
    } else if (!m.cohesion_table.empty() || m.cohesion_ratio > 0.0) {
      need(particles.initial_vertical_effective_stress, m.name, "initial_vertical_effective_stress");
      const double s = particles.initial_vertical_effective_stress[p];
      c = std::max(m.minimum_cohesion,
                   m.cohesion_table.empty() ? m.cohesion_ratio * s : interpolated(m.cohesion_table, s));
    }
    cohesion[p] = c * m.cohesion_factor;
  }
  return cohesion;
}

}  // namespace tailrun::mpm

#include "transfer_tool/audit/particle_set.hpp"

#include <cmath>
#include <numeric>

#include "common/vtkhdf.hpp"

namespace tailrun::transfer {

ParticleSet particle_set(const Snapshot& snapshot, const SamplePoints& points, const PointState& state,
                         const Assignment& assignment) {
  ParticleSet particles;
  const std::size_t n = points.count();
  particles.dimension = 2;
  particles.time = particles.transfer_time = snapshot.time;
  const double volume = std::accumulate(points.volume.begin(), points.volume.end(), 0.0);
  particles.particle_size = std::sqrt(volume / static_cast<double>(n));
  particles.material_names = assignment.material_names;
  particles.region_names = snapshot.region_names;
  particles.position = with_third(points.position);
  particles.velocity = with_third(state.velocity);
  particles.displacement = with_third(state.displacement);
  particles.mass = points.mass;
  particles.volume = points.volume;
  particles.effective_stress = state.effective_stress;
  particles.pore_pressure = state.pore_pressure;
  particles.material_id = assignment.material_id;
  for (const std::int64_t element : points.element)
    particles.region_id.push_back(snapshot.region_id[static_cast<std::size_t>(element)]);
  particles.source_element = points.element;
  particles.initial_vertical_effective_stress = state.initial_vertical_effective_stress;
  particles.depth = state.depth;
  particles.excess_pore_pressure_ratio = state.excess_pore_pressure_ratio;
  particles.residual_strength = assignment.residual_strength;
  particles.strength_law = assignment.strength_law;
  particles.strength_laws = assignment.strength_laws;
  particles.plastic_deviatoric_strain.assign(n, 0.0);
  return particles;
}

}  // namespace tailrun::transfer

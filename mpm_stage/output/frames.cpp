#include "mpm_stage/output/frames.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "common/error.hpp"
#include "common/output_place.hpp"
#include "common/vtkhdf.hpp"

namespace tailrun::mpm {

template <int Dim>
ParticleSet particle_set(const Scene& scene, const Particles<Dim>& P, double time) {
  const ParticleSet& start = scene.particles;
  const std::size_t n = P.count();
  std::vector<std::size_t> row(n);
  std::iota(row.begin(), row.end(), std::size_t{0});
  std::sort(row.begin(), row.end(), [&P](std::size_t a, std::size_t b) { return P.identity[a] < P.identity[b]; });

  ParticleSet set;
  set.dimension = start.dimension;
  set.time = start.time + time;
  set.transfer_time = start.transfer_time;
  set.particle_size = start.particle_size;
  set.material_names = start.material_names;
  set.region_names = start.region_names;
  set.terrain = start.terrain;
  set.ponds = ponds_at(scene, time);
  for (const auto& line : scene.terrain_lines) {
    const auto same = [&line](const TerrainLine& t) { return t.name == line.name; };
    if (std::any_of(set.terrain.begin(), set.terrain.end(), same)) continue;
    TerrainLine t{line.name, {}};
    for (const auto& p : line.points) t.points.insert(t.points.end(), {p[0], p[1]});
    set.terrain.push_back(std::move(t));
  }
  constexpr int components = stress_components<Dim>;
  set.position.assign(3 * n, 0.0);
  set.velocity.assign(3 * n, 0.0);
  set.displacement.assign(3 * n, 0.0);
  set.effective_stress.resize(components * n);
  set.mass.resize(n);
  set.volume.resize(n);
  set.pore_pressure.assign(n, 0.0);
  set.plastic_deviatoric_strain.resize(n);
  set.material_id.resize(n);
  const auto carry = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(n);
    for (std::size_t r = 0; r < n; ++r) to[r] = from[static_cast<std::size_t>(P.identity[row[r]])];
  };
  carry(start.region_id, set.region_id);
  carry(start.source_element, set.source_element);
  carry(start.initial_vertical_effective_stress, set.initial_vertical_effective_stress);
  carry(start.depth, set.depth);
  carry(start.excess_pore_pressure_ratio, set.excess_pore_pressure_ratio);
  carry(start.residual_strength, set.residual_strength);
  for (const auto& [name, values] : start.extra) carry(values, set.extra[name]);
  set.extra_unit = start.extra_unit;
  for (std::size_t r = 0; r < n; ++r) {
    const std::size_t p = row[r], i = static_cast<std::size_t>(P.identity[p]);
    for (int d = 0; d < Dim; ++d) {
      set.position[3 * r + d] = P.position[d][p];
      set.velocity[3 * r + d] = P.velocity[d][p];
      set.displacement[3 * r + d] = P.position[d][p] - start.position[3 * i + d] +
                                    (start.displacement.empty() ? 0.0 : start.displacement[3 * i + d]);
    }
    for (int c = 0; c < components; ++c) set.effective_stress[components * r + c] = P.stress[c][p];
    set.mass[r] = P.mass[p];
    set.volume[r] = P.volume[p];
    if (!P.pore_pressure.empty()) set.pore_pressure[r] = P.pore_pressure[p];
    set.plastic_deviatoric_strain[r] = P.plastic_strain[p];
    set.material_id[r] = P.material[p];
  }
  return set;
}

template ParticleSet particle_set<2>(const Scene&, const Particles<2>&, double);
template ParticleSet particle_set<3>(const Scene&, const Particles<3>&, double);

FrameWriter::FrameWriter(std::filesystem::path folder, Provenance provenance, Precision precision)
    : folder_(std::move(folder)), provenance_(std::move(provenance)), precision_(precision) {
  std::filesystem::create_directories(folder_);
}

FrameWriter::~FrameWriter() {
  if (thread_.joinable()) thread_.join();
}

void FrameWriter::wait() {
  if (thread_.joinable()) thread_.join();
  if (!error_) return;
  // What could not be written is not there.
  names_.pop_back();
  times_.pop_back();
  std::rethrow_exception(std::exchange(error_, nullptr));
}

void FrameWriter::restore(std::vector<std::string> names, std::vector<double> times) {
  names_ = std::move(names);
  times_ = std::move(times);
}

void FrameWriter::write(ParticleSet set) {
  wait();
  names_.push_back(fmt::format("runout_{:05d}.vtkhdf", names_.size()));
  times_.push_back(set.time);
  thread_ = std::thread([this, path = folder_ / names_.back(), set = std::move(set)] {
    try {
      write_particles(path, set, provenance_, precision_);
      write_index();
    } catch (const std::filesystem::filesystem_error& error) {
      error_ = std::make_exception_ptr(ComputationError("cannot write " + words_for(error)));
    } catch (...) {
      error_ = std::current_exception();
    }
  });
}

void FrameWriter::write_index() const {
  write_file_series(folder_ / "runout.vtkhdf.series", names_, times_);
}

}  // namespace tailrun::mpm

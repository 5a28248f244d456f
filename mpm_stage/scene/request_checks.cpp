#include "mpm_stage/scene/request_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "common/machine_memory.hpp"

namespace tailrun::mpm {

namespace {

constexpr double bytes_per_particle = 800.0;  // in memory: the set, the solver's columns and its nodes
constexpr double bytes_in_frame = 50.0;       // of a particle on disk, at least; 95 in the main case
constexpr double most_steps = 1e9, most_frames = 1e6, most_rows = 1e7;
constexpr double most_cells_from_origin = 4e6;  // 2^20 blocks of 4 cells in 3-D (block_grid.cpp)
constexpr double quarter_hour = 900.0;          // s

double likely_duration(const Scene& scene) {
  return scene.rest.active ? std::min(scene.end_time, quarter_hour) : scene.end_time;
}

// s, that viscous stress allows, as the solver has it at the start; infinite without any.
double viscous_step(const Scene& scene) {
  std::vector<double> viscosity;
  for (const auto& material : scene.materials)
    viscosity.push_back(constants_of(material, scene.cell_size).explicit_viscosity);
  double step = std::numeric_limits<double>::infinity();
  const double area = scene.cell_size * scene.cell_size;
  for (std::size_t p = 0; p < scene.particles.count(); ++p)
    if (const double eta = viscosity[static_cast<std::size_t>(scene.particles.material_id[p])]; eta > 0.0)
      step = std::min(step, scene.solver.courant * area * scene.particles.mass[p] / scene.particles.volume[p] /
                                (2.0 * scene.dimension * eta));
  return step;
}

void check_grid(const CaseNode& root, const Scene& scene) {
  const ParticleSet& set = scene.particles;
  double farthest = 0.0;
  for (std::size_t p = 0; p < set.count(); ++p)
    for (int d = 0; d < scene.dimension; ++d)
      farthest = std::max(farthest, std::fabs(set.position[3 * p + static_cast<std::size_t>(d)] - scene.origin[d]));
  const double reach = most_cells_from_origin * scene.cell_size;
  if (!(farthest < reach))
    root.fail("grid/cell_size",
              fmt::format("found {:g} m, with which the grid reaches {:.3g} m from its origin, but particles lie up to "
                          "{:.3g} m off; larger cells are required",
                          scene.cell_size, reach, farthest));
  double volume = 0.0;
  for (const double v : set.volume) volume += v;
  const double in_cell = static_cast<double>(set.count()) * std::pow(scene.cell_size, scene.dimension) / volume;
  constexpr double most_in_cell = 1e4;
  if (!(in_cell < most_in_cell))
    root.fail("grid/cell_size", fmt::format("found {:g} m, with which {:.3g} particles lie in a full cell, but at most "
                                            "{:g} are allowed",
                                            scene.cell_size, in_cell, most_in_cell));
}

void check_count(const CaseNode& root, const char* key, double interval, double duration, double most,
                 const char* what) {
  if (interval > 0.0 && !(duration / interval <= most))
    root.fail(key, fmt::format("found {:g} s, which makes {:.3g} {} in {:g} s, but at most {:g} are allowed", interval,
                               duration / interval, what, duration, most));
}

}  // namespace

double fastest_wave(const Scene& scene) {
  std::vector<double> modulus;
  for (const auto& material : scene.materials)
    modulus.push_back(constants_of(material, scene.cell_size).wave_modulus());
  double squared = 0.0;
  for (std::size_t p = 0; p < scene.particles.count(); ++p)
    squared = std::max(squared, modulus[static_cast<std::size_t>(scene.particles.material_id[p])] *
                                    scene.particles.volume[p] / scene.particles.mass[p]);
  return std::sqrt(squared);
}

void check_particle_count(const CaseNode& node, const std::array<double, 3>& along, int dimension) {
  double count = 1.0;
  for (int d = 0; d < dimension; ++d) count *= std::max(1.0, along[d]);
  const double most = std::min(1e9, machine_memory() / bytes_per_particle);
  if (!(count <= most))
    node.fail("shape", fmt::format("asks for {:.3g} particles of {:g} bytes, but this machine's memory of {:.3g} GB "
                                   "holds {:.3g}; larger cells or fewer points_per_cell_side are required",
                                   count, bytes_per_particle, machine_memory() * 1e-9, most));
}

void check_requests(const CaseNode& root, const Scene& scene) {
  check_grid(root, scene);
  const double duration = likely_duration(scene), wave = fastest_wave(scene);
  const double step = std::min(scene.solver.courant * scene.cell_size / wave, scene.solver.maximum_step);
  if (const double viscous = viscous_step(scene); viscous < step && !(duration / viscous <= most_steps))
    root.fail("materials",
              fmt::format("{:.3g} steps of {:.3g} s are needed for {:g} s, but at most {:g} are allowed: the "
                          "viscosity of a fluid asks for that on cells of {:g} m (water has 0.001 Pa s)",
                          duration / viscous, viscous, duration, most_steps, scene.cell_size));
  if (!(duration / step <= most_steps))
    root.fail(
        "time",
        fmt::format("{:.3g} steps of {:.3g} s are needed for {:g} s, but at most {:g} are allowed: the fastest wave "
                    "has {:.3g} m/s, cells have {:g} m, courant is {:g}, maximum_step {:g} s",
                    duration / step, step, duration, most_steps, wave, scene.cell_size, scene.solver.courant,
                    scene.solver.maximum_step));
  check_count(root, "output/frame_interval", scene.output.frame_interval, duration, most_frames, "frames");
  check_count(root, "output/series_interval", scene.output.series_interval, duration, most_rows, "rows");
}

void check_space(const Scene& scene, const std::filesystem::path& folder) {
  if (scene.output.frame_interval <= 0.0) return;
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  if (error) return;
  const double frames = std::floor(likely_duration(scene) / scene.output.frame_interval) + 1.0;
  double replaced = 0.0;  // bytes
  for (std::filesystem::directory_iterator file(folder / "frames", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code ignored;
    if (file->is_regular_file(ignored)) replaced += static_cast<double>(file->file_size(ignored));
  }
  const double bytes = frames * static_cast<double>(scene.particles.count()) * bytes_in_frame;
  if (bytes > static_cast<double>(space.available) + replaced)
    throw InputError(fmt::format(
        "/output/frame_interval: {:.3g} frames of {} particles take {:.3g} GB or more, but {} has {:.3g} GB "
        "left",
        frames, scene.particles.count(), bytes * 1e-9, folder.string(), static_cast<double>(space.available) * 1e-9));
}

}  // namespace tailrun::mpm

// Snapshots for the tests: a rectangle of nx x ny distorted quadrilaterals, with any fields put onto it.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "common/element_mean.hpp"
#include "common/snapshot.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace example {

using tailrun::Snapshot;

// Numbers in [-1, 1) from a linear congruential generator (Knuth's MMIX constants): the same on every machine.
class Noise {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1.0;
  }

 private:
  std::uint64_t state_ = 14;
};

// Rectangle [0, nx] x [0, ny] m in unit quadrilaterals whose inner nodes are moved by up to `distortion` m. Regions:
// "lower" below y = ny/2, "upper" above. Every field is zero but density (1800 and 2000 kg/m3) and thickness (1 m).
inline Snapshot rectangle(int nx, int ny, double distortion = 0.25) {
  Snapshot mesh;
  mesh.region_names = {"lower", "upper"};
  Noise noise;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const bool is_inner = i > 0 && i < nx && j > 0 && j < ny && 2 * j != ny;
      mesh.position.push_back(i + (is_inner ? distortion * noise() : 0.0));
      mesh.position.push_back(j + (is_inner ? distortion * noise() : 0.0));
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const std::int64_t first = j * (nx + 1) + i;
      mesh.quads.insert(mesh.quads.end(), {first, first + 1, first + nx + 2, first + nx + 1});
      const bool is_upper = 2 * j >= ny;
      mesh.region_id.push_back(is_upper ? 1 : 0);
      mesh.density.push_back(is_upper ? 2000.0 : 1800.0);
    }
  const std::size_t nodes = mesh.nodes(), elements = mesh.elements();
  for (auto* field : {&mesh.displacement, &mesh.velocity, &mesh.acceleration}) field->assign(2 * nodes, 0.0);
  for (auto* field : {&mesh.pore_pressure, &mesh.excess_pore_pressure}) field->assign(nodes, 0.0);
  for (auto* field : {&mesh.effective_stress, &mesh.total_stress, &mesh.initial_effective_stress})
    field->assign(4 * elements, 0.0);
  for (auto* field : {&mesh.initial_vertical_effective_stress, &mesh.initial_pore_pressure, &mesh.depth,
                      &mesh.excess_pore_pressure_ratio, &mesh.max_excess_pore_pressure_ratio,
                      &mesh.effective_stress_ratio, &mesh.shear_strain})
    field->assign(elements, 0.0);
  mesh.thickness.assign(elements, 1.0);
  mesh.porosity.assign(elements, 0.4);
  mesh.scaled_jacobian.assign(elements, 1.0);
  return mesh;
}

// Puts f(x, y) onto component k of a nodal field.
inline void set_nodal(const Snapshot& mesh, std::vector<double>& field, std::size_t columns, std::size_t k,
                      const std::function<double(double, double)>& f) {
  for (std::size_t node = 0; node < mesh.nodes(); ++node)
    field[columns * node + k] = f(mesh.position[2 * node], mesh.position[2 * node + 1]);
}

// Total stress from effective stress and the nodes' mean pore pressure.
inline void set_total_stress(Snapshot& mesh) {
  mesh.total_stress = mesh.effective_stress;
  for (std::size_t e = 0; e < mesh.elements(); ++e)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.total_stress[4 * e + k] -= tailrun::element_mean(mesh.quads, mesh.pore_pressure, e);
}

// Displacements and velocities that vary over every node, so that nothing agrees by accident.
inline void set_motion(Snapshot& mesh) {
  Noise noise;
  for (double& value : mesh.displacement) value = 0.1 * noise();
  for (double& value : mesh.velocity) value = 2.0 * noise();
  mesh.base_velocity = {0.3, -0.1};
}

inline tailrun::transfer::SamplingOptions sampling(tailrun::transfer::Layout layout, int points) {
  tailrun::transfer::SamplingOptions options;
  options.layout = layout;
  options.points = {points, points};
  options.kept_region = {true, true};
  return options;
}

inline tailrun::transfer::SamplePoints sample_all(const Snapshot& mesh, tailrun::transfer::Layout layout, int points) {
  return tailrun::transfer::sample(mesh, std::vector<bool>(mesh.elements(), true), sampling(layout, points));
}

// A file in a folder of its own that goes when the test ends.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("tailrun_transfer_" + std::to_string(::getpid()) + "_" + std::to_string(++count));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// The message of the exception of type `Error` that `call` throws; empty when it throws none.
template <typename Error, typename Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace example

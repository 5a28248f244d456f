// The two file formats: what is written is read back, and what is damaged is refused.
#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <thread>

#include "common/error.hpp"
#include "common/particles.hpp"
#include "common/snapshot.hpp"

using namespace tailrun;

namespace {

const auto folder = std::filesystem::temp_directory_path();

Snapshot small_snapshot() {
  Snapshot s;
  s.time = 16.0;
  s.base_velocity = {0.1, 0.0};
  s.region_names = {"tailings"};
  s.position = {0, 0, 1, 0, 1, 1, 0, 1};
  s.displacement = s.velocity = s.acceleration = {1, 2, 3, 4, 5, 6, 7, 8};
  s.pore_pressure = s.excess_pore_pressure = {1e3, 2e3, 3e3, 4e3};
  s.quads = {0, 1, 2, 3};
  s.region_id = {0};
  s.effective_stress = s.total_stress = s.initial_effective_stress = {-1e4, -2e4, -1e4, 5e3};
  s.thickness = s.density = s.porosity = s.initial_vertical_effective_stress = s.initial_pore_pressure =
      s.depth = {2.0};
  s.excess_pore_pressure_ratio = s.max_excess_pore_pressure_ratio = s.effective_stress_ratio = s.shear_strain =
      s.scaled_jacobian = {0.5};
  s.lines = {{"base", {0, 1}}, {"face", {1, 2}}};
  s.ponds = {{0.8, {"face", "base"}}};
  s.phreatic_line = {-1, 0.5, 2, 0.5};
  return s;
}

ParticleSet small_particles() {
  ParticleSet p;
  p.material_names = {"liquefied"};
  p.region_names = {"tailings"};
  p.position = {0, 1, 0, 2, 3, 0};
  p.velocity = {0, 0, 0, 1, 1, 0};
  p.mass = {1.0, 2.0};
  p.volume = {0.1, 0.2};
  p.effective_stress = {-1, -2, -3, 4, -5, -6, -7, 8};
  p.pore_pressure = {10, 20};
  p.material_id = {0, 0};
  p.residual_strength = {3200, 9100};
  p.strength_law = {1, -1};
  p.strength_laws = {"{}", "{\"model\": \"constant\"}"};
  p.extra["percentile"] = {0.5, 0.5};
  p.notes["audit"] = "{\"mass\": 3}";
  p.terrain = {{"bed", {0, 0, 10, 0}}};
  p.ponds = {{"face", 0.8, {-1, 2}, {true, false}, 1030}, {"other", 2, {4, 5}, {false, false}, 1000}};
  return p;
}

}  // namespace

TEST_CASE("a snapshot comes back as it was") {
  const auto path = folder / "tailrun_snapshot.h5";
  const Snapshot s = small_snapshot();
  write_snapshot(path, s, {});
  const Snapshot r = read_snapshot(path);
  CHECK(r.time == 16.0);
  CHECK(r.displacement == s.displacement);
  CHECK(r.effective_stress == s.effective_stress);
  CHECK(r.phreatic_line == s.phreatic_line);
  REQUIRE(r.ponds.size() == 1);
  CHECK(r.ponds[0].level == 0.8);
  CHECK(r.ponds[0].lines == s.ponds[0].lines);
  CHECK(r.lines.at(0).edges == s.lines[0].edges);
  CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST_CASE("in single precision a particle's fields come back with seven digits, its place as it was") {
  const auto path = folder / "tailrun_single.h5";
  ParticleSet p = small_particles();
  p.volume = {0.1, 1.0 / 3.0};
  p.position[0] = 1.0 / 3.0;
  write_particles(path, p, {}, tailrun::Precision::single);
  const ParticleSet r = read_particles(path);
  CHECK(r.volume[1] != p.volume[1]);
  CHECK(r.volume[1] == doctest::Approx(p.volume[1]).epsilon(1e-7));
  CHECK(r.position == p.position);
  CHECK(r.terrain[0].points == p.terrain[0].points);
}

TEST_CASE("particles come back as they were, with further fields and notes") {
  const auto path = folder / "tailrun_particles.h5";
  const ParticleSet p = small_particles();
  write_particles(path, p, {});
  const ParticleSet r = read_particles(path);
  REQUIRE(r.ponds.size() == 2);
  CHECK(r.ponds[0].name == "face");
  CHECK(r.ponds[0].level == 0.8);
  CHECK(r.ponds[0].extent == p.ponds[0].extent);
  CHECK(r.ponds[0].endless == p.ponds[0].endless);
  CHECK(r.ponds[0].density == 1030);
  CHECK(r.effective_stress == p.effective_stress);
  CHECK(r.residual_strength == p.residual_strength);
  CHECK(r.strength_law == p.strength_law);
  CHECK(r.strength_laws == p.strength_laws);
  CHECK(r.extra.at("percentile") == p.extra.at("percentile"));
  CHECK(r.notes.at("audit") == p.notes.at("audit"));
  CHECK(r.terrain.at(0).points == p.terrain[0].points);
  CHECK(r.depth.empty());
}

TEST_CASE("the wrong file, a cut file and values that are not finite are refused") {
  const auto snapshot = folder / "tailrun_snapshot2.h5", particles = folder / "tailrun_particles2.h5";
  write_snapshot(snapshot, small_snapshot(), {});
  CHECK_THROWS_AS(read_particles(snapshot), InputError);
  CHECK_THROWS_AS(read_snapshot(folder / "tailrun_missing.h5"), InputError);
  ParticleSet p = small_particles();
  p.mass[1] = -1.0;
  write_particles(particles, p, {});
  CHECK_THROWS_AS(read_particles(particles), InputError);
  p.mass[1] = 1.0;
  p.strength_law[1] = 2;
  write_particles(particles, p, {});
  CHECK_THROWS_AS(read_particles(particles), InputError);
  p.strength_law[1] = -1;
  p.pore_pressure[0] = std::numeric_limits<double>::quiet_NaN();
  write_particles(particles, p, {});
  CHECK_THROWS_AS(read_particles(particles), InputError);
  std::filesystem::resize_file(snapshot, std::filesystem::file_size(snapshot) / 2);
  CHECK_THROWS_AS(read_snapshot(snapshot), InputError);
}

TEST_CASE("gravity upwards, water without a density and particles of negative size are refused") {
  const auto path = folder / "tailrun_impossible.h5";
  for (const auto& [gravity, density] : {std::pair{-9.81, 1000.0}, std::pair{9.81, 0.0}}) {
    Snapshot wrong = small_snapshot();
    wrong.gravity = gravity;
    wrong.fluid_density = density;
    write_snapshot(path, wrong, {});
    CHECK_THROWS_WITH_AS(read_snapshot(path), doctest::Contains("gravity_m_s2 is"), InputError);
  }
  ParticleSet points = small_particles();
  points.particle_size = -0.5;
  write_particles(path, points, {});
  CHECK_THROWS_WITH_AS(read_particles(path), doctest::Contains("particle_size_m is -0.5"), InputError);
}

TEST_CASE("SHA-256 of a known text") {
  CHECK(sha256_of_text("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Flips one bit in every `stride`th byte of the file, one after the other. `read` returns whether what it read is as
// it was; it throws InputError where the damage is noticed. Returns how many flips were noticed.
int flips_noticed(const std::filesystem::path& path, std::size_t stride, const std::function<bool()>& read) {
  const std::string whole = bytes_of(path);
  int noticed = 0, silent = 0;
  for (std::size_t k = 0; k < whole.size(); k += stride) {
    std::string damaged = whole;
    damaged[k] = static_cast<char>(damaged[k] ^ (1 << (k / stride % 8)));
    std::ofstream(path, std::ios::binary) << damaged;
    try {
      if (!read()) ++silent;
    } catch (const InputError&) {
      ++noticed;
    }
  }
  CHECK(silent == 0);
  return noticed;
}

}  // namespace

TEST_CASE("one flipped bit anywhere is noticed, or lies where no value does") {
  const auto snapshot_path = folder / "tailrun_flip_snapshot.h5", particles_path = folder / "tailrun_flip_particles.h5";
  const Snapshot s = small_snapshot();
  write_snapshot(snapshot_path, s, {});
  CHECK(flips_noticed(snapshot_path, 61, [&] {
          const Snapshot r = read_snapshot(snapshot_path);
          return r.displacement == s.displacement && r.velocity == s.velocity && r.time == s.time &&
                 r.effective_stress == s.effective_stress && r.density == s.density && r.quads == s.quads &&
                 r.position == s.position && r.pore_pressure == s.pore_pressure && r.gravity == s.gravity &&
                 r.region_names == s.region_names && r.phreatic_line == s.phreatic_line;
        }) > 50);
  const ParticleSet p = small_particles();
  write_particles(particles_path, p, {});
  CHECK(flips_noticed(particles_path, 41, [&] {
          const ParticleSet r = read_particles(particles_path);
          return r.position == p.position && r.velocity == p.velocity && r.mass == p.mass && r.volume == p.volume &&
                 r.effective_stress == p.effective_stress && r.pore_pressure == p.pore_pressure &&
                 r.residual_strength == p.residual_strength && r.notes == p.notes && r.extra == p.extra &&
                 r.material_names == p.material_names && r.time == p.time;
        }) > 50);
}

TEST_CASE("equal states make files of equal bytes") {
  const auto first = folder / "tailrun_equal_1.h5", second = folder / "tailrun_equal_2.h5";
  write_particles(first, small_particles(), {});
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // times in HDF5 headers count whole seconds
  write_particles(second, small_particles(), {});
  CHECK(bytes_of(first) == bytes_of(second));
  write_snapshot(first, small_snapshot(), {});
  write_snapshot(second, small_snapshot(), {});
  CHECK(bytes_of(first) == bytes_of(second));
}

TEST_CASE("a device or a folder is not replaced by a file") {
  CHECK_THROWS_WITH_AS(write_particles("/dev/null", small_particles(), {}), doctest::Contains("is a device"),
                       InputError);
  CHECK_THROWS_WITH_AS(write_particles(folder, small_particles(), {}), doctest::Contains("is a folder"), InputError);
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

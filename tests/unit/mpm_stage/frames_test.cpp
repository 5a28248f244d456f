#include "mpm_stage/output/frames.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "common/error.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

ParticleSet two_particles(double time) {
  ParticleSet set;
  set.dimension = 2;
  set.time = time;
  set.particle_size = 0.5;
  set.material_names = {"sand"};
  set.position = {0.0, 0.0, 0.0, 1.0, time, 0.0};
  set.velocity.assign(6, 0.0);
  set.displacement.assign(6, 0.0);
  set.effective_stress.assign(8, -1e3);
  set.mass = {500.0, 500.0};
  set.volume = {0.25, 0.25};
  set.pore_pressure.assign(2, 0.0);
  set.plastic_deviatoric_strain.assign(2, 0.0);
  set.material_id.assign(2, 0);
  return set;
}

}  // namespace

TEST_CASE("frames written in the background are all there after a wait, and a failure comes back to the computation") {
  const auto folder = std::filesystem::temp_directory_path() / ("tailrun_frames_" + std::to_string(getpid()));
  FrameWriter frames(folder, Provenance{}, tailrun::Precision::full);
  for (int k = 0; k < 3; ++k) frames.write(two_particles(k));
  frames.wait();
  CHECK(frames.count() == 3);
  CHECK(read_particles(folder / frames.last()).position == two_particles(2.0).position);
  CHECK(read_particles(folder / frames.names().front()).time == 0.0);
  CHECK(std::filesystem::exists(folder / "runout.vtkhdf.series"));

  FrameWriter small(folder, Provenance{}, tailrun::Precision::single);
  ParticleSet set = two_particles(3.0);
  set.volume[0] = 1.0 / 3.0;
  small.write(set);
  small.wait();
  const double volume = read_particles(folder / small.last()).volume[0];
  CHECK(volume != set.volume[0]);
  CHECK(volume == doctest::Approx(set.volume[0]).epsilon(1e-7));

  std::filesystem::remove_all(folder);
  std::ofstream(folder) << "a file in the folder's place";
  frames.write(two_particles(3.0));
  CHECK_THROWS_AS(frames.write(two_particles(4.0)), ComputationError);
  frames.write(two_particles(5.0));
  CHECK_THROWS_AS(frames.wait(), ComputationError);
  CHECK_NOTHROW(frames.wait());
  std::filesystem::remove(folder);
}

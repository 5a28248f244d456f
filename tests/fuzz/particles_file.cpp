// Particles files (HDF5). Those of the corpus have no checksums, so that a changed byte gets through to our reader.
#include "common/particles.hpp"

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(particles_file, "particles.h5", path) {
  const auto particles = tailrun::read_particles(path);
  for (const double m : particles.mass) tailrun::fuzz::require(m > 0.0, "a mass is not positive");
}

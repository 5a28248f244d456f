// Motions in two columns.
#include <cmath>

#include "common/motion.hpp"
#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(motion_csv, "motion.csv", path) {
  const auto motion = tailrun::read_motion(path);
  tailrun::fuzz::require(motion.time_step > 0.0, "the time step is not positive");
  tailrun::fuzz::require(motion.acceleration.size() == motion.velocity.size(), "velocities are missing");
  for (const double v : motion.velocity) tailrun::fuzz::require(std::isfinite(v), "a velocity is not finite");
}

#include "mpm_stage/step/surface_age.hpp"

#include <doctest/doctest.h>

using tailrun::mpm::SurfaceAge;

namespace {

// Steps from one finding of the surfaces to the next, of particles that drift by `drift` cells in each.
int steps_between(double drift) {
  SurfaceAge age;
  int steps = 0;
  do {
    age.pass(drift, false);
    ++steps;
  } while (!age.due());
  return steps;
}

}  // namespace

TEST_CASE(
    "surfaces are found at first, again when particles may have moved by a twentieth of a cell, or after a while") {
  CHECK(SurfaceAge().due());
  CHECK(steps_between(0.3) == 1);
  CHECK(steps_between(0.02) == 3);
  CHECK(steps_between(0.0) == SurfaceAge::most_steps);
}

TEST_CASE("surfaces are found after a sort, and what drifted before counts no more") {
  SurfaceAge age;
  age.pass(0.04, false);
  CHECK_FALSE(age.due());
  age.pass(0.0, true);
  CHECK(age.due());
  age.pass(0.04, false);
  CHECK_FALSE(age.due());
  age.pass(0.02, false);
  CHECK(age.due());
}

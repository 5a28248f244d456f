#include "mpm_stage/step/sleeping_blocks.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun::mpm;

namespace {

constexpr double cell = 0.25, speed_of_hit = 0.5;

// An elastic bar, 16 x 0.5 m, at rest in empty space; a piece of the same comes from the left.
Particles<2> bar_and_piece() {
  std::vector<std::array<double, 3>> points;  // x, y, velocity
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 128; ++i) points.push_back({2.0 + 0.125 * (i + 0.5), 0.125 * (j + 0.5), 0.0});
    for (int i = 0; i < 8; ++i) points.push_back({0.5 + 0.125 * (i + 0.5), 0.125 * (j + 0.5), speed_of_hit});
  }
  Particles<2> P;
  P.resize(points.size(), true, false);
  for (std::size_t p = 0; p < points.size(); ++p) {
    P.position[0][p] = points[p][0];
    P.position[1][p] = points[p][1];
    P.velocity[0][p] = points[p][2];
    P.volume[p] = 0.125 * 0.125;
    P.mass[p] = 1000.0 * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  return P;
}

struct Outcome {
  std::vector<double> x;  // by identity, m
  double momentum = 0.0, asleep_before = 0.0, asleep_after = 0.0;
};

Outcome run(const SleepOptions& sleep) {
  Material m;
  m.name = "rubber";
  m.model = Model::linear_elastic;
  m.youngs_modulus = 1e5;
  m.poisson_ratio = 0.0;
  SolverOptions o;
  o.sleep = sleep;
  const Terrain none;
  auto s = make_solver<2>(o, cell, {}, bar_and_piece(), {m}, none, Walls<2>{});
  s->start(1e30);
  Outcome out;
  for (double t = 0.0; t < 3.0;) {
    const StepReport report = s->step({0, 0}, {0, 0}, 1e30);
    t += report.dt;
    (t < 0.6 ? out.asleep_before : out.asleep_after) += static_cast<double>(report.asleep);
  }
  const Particles<2>& P = s->particles();
  out.x.resize(P.count());
  for (std::size_t p = 0; p < P.count(); ++p) {
    out.x[static_cast<std::size_t>(P.identity[p])] = P.position[0][p];
    out.momentum += P.mass[p] * P.velocity[0][p];
  }
  return out;
}

}  // namespace

TEST_CASE("a sleeping bar wakes to the wave that hits it, and ends where one that never slept does") {
  const Outcome awake = run({}), slept = run({.speed = 1e-4, .calm = 0.05, .nap = 0.5});
  CHECK(awake.asleep_before + awake.asleep_after == 0.0);
  CHECK(slept.asleep_before > 0.0);
  double largest = 0.0, moved = 0.0;
  for (std::size_t p = 0; p < awake.x.size(); ++p) {
    largest = std::max(largest, std::fabs(awake.x[p] - slept.x[p]));
    moved = std::max(moved, std::fabs(awake.x[p] - bar_and_piece().position[0][p]));
  }
  CHECK(moved > 0.1);
  CHECK(largest < 0.01 * moved);
  CHECK(slept.momentum == doctest::Approx(awake.momentum).epsilon(5e-3));
}

TEST_CASE("a nap ends by itself, and calm has to last") {
  SleepingBlocks<2> sleep({.speed = 0.1, .calm = 0.2, .nap = 0.3});
  sleep.restore({0.0});
  CHECK_FALSE(sleep.fall_asleep(0, 1e-4, 0.15));
  CHECK_FALSE(sleep.fall_asleep(0, 1.0, 0.15));  // too fast: from the start again
  CHECK_FALSE(sleep.fall_asleep(0, 1e-4, 0.15));
  CHECK(sleep.fall_asleep(0, 1e-4, 0.15));
  CHECK(sleep.asleep(0));
  CHECK(sleep.doze(0, 0.2));
  CHECK_FALSE(sleep.doze(0, 0.2));
  CHECK_FALSE(sleep.asleep(0));
}

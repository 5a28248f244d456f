#include "mpm_stage/step/sleeping_blocks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

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
  m.law = &law_named("linear_elastic");
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

TEST_CASE("after a sort blocks keep their clocks, are put on the nodes anew, and wake when a moving particle came in") {
  Particles<2> P;
  P.resize(2, true, false);
  P.position[0] = {1.0, 5.0};  // blocks 0 and 2 of 2 m
  P.position[1] = {1.0, 1.0};
  P.identity = {0, 1};
  BlockGrid<2> grid(cell, {}, 0.0);
  grid.sort(P);
  SleepingBlocks<2> sleep({.speed = 0.1, .calm = 0.2, .nap = 0.3});
  sleep.restore({-0.2, -0.1});
  sleep.put_on_nodes(0);
  sleep.put_on_nodes(1);
  sleep.before_sort(grid);
  P.position[0][0] = 3.0;  // block 1
  grid.sort(P);
  sleep.after_sort(grid, [](std::size_t) { return false; });
  CHECK(sleep.clocks() == std::vector<double>{0.0, -0.1});
  CHECK(sleep.stale(0));
  CHECK(sleep.stale(1));
  sleep.before_sort(grid);
  P.position[0][0] = 5.0;  // into the block that sleeps
  grid.sort(P);
  sleep.after_sort(grid, [](std::size_t b) { return b == 0; });
  CHECK(sleep.clocks() == std::vector<double>{0.0});
}

namespace {

Material elastic(const char* name, double youngs_modulus) {
  Material m;
  m.name = name;
  m.law = &law_named("linear_elastic");
  m.youngs_modulus = youngs_modulus;
  m.poisson_ratio = 0.0;
  return m;
}

// A stiff block of 4 x 1.5 m at rest (wave speed 316 m/s, material 1), and a soft one (10 m/s) 1.375 m above it, in
// other blocks of the grid.
std::unique_ptr<Solver<2>> soft_over_stiff(const SleepOptions& sleep, double speed, bool soft_too) {
  std::vector<std::array<double, 3>> points;  // x, y, material
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 32; ++i) points.push_back({0.125 * (i + 0.5), 0.125 * (j + 0.5), 1.0});
  for (int j = 0; j < 8 && soft_too; ++j)
    for (int i = 8; i < 24; ++i) points.push_back({0.125 * (i + 0.5), 2.875 + 0.125 * (j + 0.5), 0.0});
  Particles<2> P;
  P.resize(points.size(), true, false);
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (int d = 0; d < 2; ++d) P.position[d][p] = points[p][d];
    P.material[p] = static_cast<std::int32_t>(points[p][2]);
    if (P.material[p] == 0) P.velocity[1][p] = -speed;
    P.volume[p] = 0.125 * 0.125;
    P.mass[p] = 1000.0 * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  SolverOptions o;
  o.sleep = sleep;
  static const Terrain none;
  auto s = make_solver<2>(o, cell, {}, std::move(P), {elastic("rubber", 1e5), elastic("rock", 1e8)}, none, Walls<2>{});
  s->start(1e30);
  return s;
}

constexpr double stiff_step = 0.5 * cell / 316.3;  // s, Courant number 0.5

}  // namespace

TEST_CASE("blocks that sleep limit the time step as if they were awake: the stiff ones, and when all sleep") {
  const SleepOptions sleep{.speed = 1e-3, .calm = 0.01, .nap = 0.2};
  for (const bool soft_too : {true, false}) {
    CAPTURE(soft_too);
    auto s = soft_over_stiff(sleep, 0.2, soft_too);
    const double first = s->next_dt();
    CHECK(first == doctest::Approx(stiff_step).epsilon(0.01));
    std::size_t most = 0;
    for (double t = 0.0; t < 0.5;) {
      const StepReport report = s->step({0, 0}, {0, 0}, 1e30);
      t += report.dt;
      most = std::max(most, report.asleep);
      CHECK(report.next_dt <= first * (1.0 + 1e-3));
    }
    CHECK(most == 12 * 32);
  }
}

TEST_CASE("a sleeping stiff block that is hit has the stress that it has awake") {
  const auto largest_stress = [](const SleepOptions& sleep, double& asleep) {
    auto s = soft_over_stiff(sleep, 1.0, true);
    double most = 0.0;
    for (double t = 0.0; t < 1.7;) {
      const StepReport report = s->step({0, 0}, {0, 0}, 1e30);
      t += report.dt;
      asleep += static_cast<double>(report.asleep);
      const Particles<2>& P = s->particles();
      for (std::size_t p = 0; p < P.count(); ++p)
        if (P.material[p] == 1) most = std::max(most, std::fabs(P.stress[1][p]));
    }
    return most;
  };
  double none = 0.0, asleep = 0.0;
  const double awake = largest_stress({}, none);
  const double slept = largest_stress({.speed = 1e-3, .calm = 0.01, .nap = 0.2}, asleep);
  CHECK(none == 0.0);
  CHECK(asleep > 0.0);
  // The soft block's density times wave speed times velocity of impact, and what roughness of the contact adds to it.
  CHECK(awake > 1e4);
  CHECK(awake < 2e5);
  CHECK(slept == doctest::Approx(awake).epsilon(0.02));
}

TEST_CASE("a stiff column that sleeps as a whole under its weight has the stress of its weight when it wakes") {
  Particles<2> P;
  P.resize(16 * 16, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = 0.125 * (static_cast<double>(p % 16) + 0.5);
    P.position[1][p] = 0.125 * (static_cast<double>(p / 16) + 0.5);
    P.volume[p] = 0.125 * 0.125;
    P.mass[p] = 1000.0 * P.volume[p];
    P.stress[1][p] = -1000.0 * 9.81 * (2.0 - P.position[1][p]);
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  Walls<2> walls;
  walls.bounded = true;
  walls.high = {8.0, 8.0};
  walls.side[1][0].kind = WallKind::slip;
  SolverOptions o;
  o.sleep = {.speed = 0.01, .calm = 0.02, .nap = 0.1};
  const Terrain none;
  auto s = make_solver<2>(o, cell, {}, std::move(P), {elastic("rock", 1e8)}, none, walls);
  s->start(1e30);
  std::size_t most = 0;
  int wakes = 0;
  bool slept = false;
  double largest = 0.0;
  for (double t = 0.0; t < 1.0;) {
    const StepReport report = s->step({0, -9.81}, {0, 0}, 0.05);  // rows of the series every 0.05 s
    t += report.dt;
    most = std::max(most, report.asleep);
    wakes += slept && report.asleep == 0 ? 1 : 0;
    slept = report.asleep > 0;
    for (std::size_t p = 0; p < s->particles().count(); ++p)
      largest = std::max(largest, std::fabs(s->particles().stress[1][p]));
  }
  CHECK(most == 16 * 16);
  CHECK(wakes > 3);
  CHECK(largest < 1.02 * 1000.0 * 9.81 * 2.0);
}

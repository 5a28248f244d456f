#include <doctest/doctest.h>

#include <cmath>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.25, height = 2.0, width = 1.0;

// A column of elastic soil between slip walls on a fixed base.
struct Column {
  Walls<2> walls;
  Particles<2> particles;
  Material soil;

  Column() {
    walls.bounded = true;
    walls.high = {width, 4.0};
    walls.side[0][0].kind = walls.side[0][1].kind = WallKind::slip;
    walls.side[1][0].kind = WallKind::fixed;
    const double spacing = 0.5 * h;
    const int nx = static_cast<int>(width / spacing), ny = static_cast<int>(height / spacing);
    particles.resize(static_cast<std::size_t>(nx * ny), true, false);
    for (std::size_t p = 0; p < particles.count(); ++p) {
      particles.position[0][p] = (static_cast<double>(p % nx) + 0.5) * spacing;
      particles.position[1][p] = (static_cast<double>(p / nx) + 0.5) * spacing;
      particles.volume[p] = spacing * spacing;
      particles.mass[p] = 2000.0 * particles.volume[p];
      particles.identity[p] = static_cast<std::int32_t>(p);
    }
    soil.name = "soil";
    soil.law = &law_named("linear_elastic");
    soil.youngs_modulus = 1e6;
    soil.poisson_ratio = 0.25;
  }
};

}  // namespace

TEST_CASE("a plate that presses on a confined column feels the constrained modulus times the strain") {
  Column column;
  MovingBody<2> plate;
  plate.name = "plate";
  plate.low = {-0.5, height};
  plate.high = {width + 0.5, height + 1.0};
  plate.time = {0.0, 2.0, 2.1};
  plate.velocity = {{0.0, -0.01}, {0.0, -0.01}, {0.0, 0.0}};
  column.walls.bodies.push_back(plate);
  SolverOptions o;
  o.transfer = TransferName::apic;
  const Terrain none;
  auto s = make_solver<2>(o, h, {0, 0}, std::move(column.particles), {column.soil}, none, column.walls);
  s->start(1e30);
  double time = 0.0, at_three = 0.0, impulse = 0.0;
  while (time < 4.0) {
    time += s->step({0, 0}, {0, 0}, 1e30).dt;
    if (at_three == 0.0 && time >= 3.0) {
      at_three = time;
      impulse = s->bodies()[0].impulse[1];
    }
  }
  const double pushed = -s->bodies()[0].displacement[1];
  CHECK(pushed == doctest::Approx(0.0205).epsilon(1e-3));
  const double modulus = 1e6 * 0.75 / (1.25 * 0.5);
  const double force = (s->bodies()[0].impulse[1] - impulse) / (time - at_three);
  // Splines smooth the step from the plate's velocity to that of the soil, which counts up to half a cell as soil.
  const auto of_height = [&](double l) { return modulus * width * std::log(l / (l - pushed)); };
  CHECK(force < of_height(height));
  CHECK(force > of_height(height + 0.5 * h));
  // All the energy there is came from the plate.
  double kinetic = 0.0;
  for (std::size_t p = 0; p < s->particles().count(); ++p)
    kinetic += 0.5 * s->particles().mass[p] * std::pow(s->particles().velocity[1][p], 2);
  CHECK(s->work().external == doctest::Approx(s->elastic_energy() + kinetic).epsilon(0.05));
}

TEST_CASE("local damping is booked for the body alone, not for its mirror image") {
  Column column;
  SolverOptions o;
  o.local_damping = 0.4;
  const Terrain none;
  auto s = make_solver<2>(o, h, {0, 0}, std::move(column.particles), {column.soil}, none, column.walls);
  s->start(1e30);
  const auto fallen = [&] {
    double sum = 0.0;
    for (std::size_t p = 0; p < s->particles().count(); ++p)
      sum += s->particles().mass[p] * s->particles().position[1][p];
    return -9.81 * sum;
  };
  const double start = fallen();
  double kinetic = 0.0;
  for (int i = 0; i < 3000; ++i) kinetic = s->step({0, -9.81}, {0, 0}, 1e30).kinetic_energy;
  const double released = fallen() - start, left = s->elastic_energy() + kinetic;
  CHECK(s->work().damping > 0.0);
  CHECK(s->work().damping == doctest::Approx(released - left).epsilon(0.03));
}

TEST_CASE("a blade that pushes a block along the ground feels the friction of what presses on that") {
  constexpr double friction = 0.4, speed = 2.0, spacing = 0.25, density = 2000.0, gravity = 9.81;
  constexpr std::size_t columns = 24, rows = 8;
  Particles<2> P;
  P.resize(columns * rows, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = (static_cast<double>(p % columns) + 0.5) * spacing;
    P.position[1][p] = (static_cast<double>(p / columns) + 0.5) * spacing;
    P.velocity[0][p] = speed;
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.stress[1][p] = -density * gravity * (spacing * static_cast<double>(rows) - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = 0.4 * P.stress[1][p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  Material block;
  block.law = &law_named("linear_elastic");
  block.youngs_modulus = 1e7;
  block.poisson_ratio = 0.3;
  Walls<2> walls;
  walls.bodies.push_back({"blade", {-2.0, -1.0}, {0.0, 3.0}, {0.0}, {{speed, 0.0}}});
  Terrain ground;
  ground.add_line({{{-20.0, 0.0}}, {{80.0, 0.0}}}, {friction}, false);
  SolverOptions o;
  o.transfer = TransferName::aflip;
  auto s = make_solver<2>(o, 0.5, {0, 0}, std::move(P), {block}, ground, walls);
  s->start(1e30);
  for (double time = 0.0; time < 6.0;) time += s->step({0, -gravity}, {0, 0}, 1e30).dt;
  const auto ground_gave = s->boundary_impulse(), blade = s->bodies()[0].impulse;
  // Rough, the blade carries some of the weight or adds to it.
  CHECK(ground_gave[1] - blade[1] == doctest::Approx(density * gravity * 12.0 * 6.0).epsilon(0.01));
  CHECK(-ground_gave[0] == doctest::Approx(friction * ground_gave[1]).epsilon(0.01));
  CHECK(-blade[0] == doctest::Approx(friction * ground_gave[1]).epsilon(0.01));
}

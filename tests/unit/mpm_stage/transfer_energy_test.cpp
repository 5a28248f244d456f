// What the default transfer keeps of a particle's own motion is never more than the particle had.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.25;

Material clay(double youngs_modulus, double cohesion) {
  Material m;
  m.name = "clay";
  m.law = &law_named("tresca");
  m.youngs_modulus = youngs_modulus;
  m.poisson_ratio = 0.33;
  m.cohesion = cohesion;
  return m;
}

// J, sum m (v . v + D C : C) / 2 with D = h^2 / 4 (quadratic splines).
template <int Dim>
double kinetic_energy(const Particles<Dim>& P) {
  double twice = 0.0;
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (const auto& v : P.velocity) twice += P.mass[p] * v[p] * v[p];
    for (const auto& c : P.affine) twice += P.mass[p] * 0.25 * h * h * c[p] * c[p];
  }
  return 0.5 * twice;
}

// A cloud of dust, each particle with a velocity of its own.
template <int Dim>
void check_dust(double damping) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.0, 1.5), speed(-1.0, 1.0);
  Particles<Dim> P;
  P.resize(300, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (int d = 0; d < Dim; ++d) {
      P.position[d][p] = place(random);
      P.velocity[d][p] = 20.0 + speed(random);
    }
    P.volume[p] = std::pow(0.5 * h, Dim);
    P.mass[p] = 2000.0 * P.volume[p];
    P.strength[p] = 0.0;
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  SolverOptions o;
  o.transfer_damping = o.flow_transfer_damping = damping;
  o.maximum_step = 1e-3;
  const Terrain none;
  const auto s = make_solver<Dim>(o, h, {}, std::move(P), {clay(1.0, 0.0)}, none, Walls<Dim>{});
  s->start(1e30);
  s->step({}, {}, 1e30);  // here particles take affine velocities from the grid
  double before = kinetic_energy(s->particles());
  const double first = before;
  const double mean = 0.5 * 300.0 * 2000.0 * std::pow(0.5 * h, Dim) * Dim * 400.0, scatter = before - mean;
  for (int n = 0; n < 200; ++n) {
    s->step({}, {}, 1e30);
    const double now = kinetic_energy(s->particles());
    CHECK(now < before + 1e-4 * std::fabs(scatter));
    before = now;
  }
  CHECK(before < first + (damping > 0.0 ? 0.0 : 1e-3 * scatter));
}

}  // namespace

TEST_CASE("a cloud of dust that flies along loses its motion under the grid's resolution and gains none") {
  for (const double damping : {0.0, 0.3}) {
    CAPTURE(damping);
    check_dust<2>(damping);
    check_dust<3>(damping);
  }
}

TEST_CASE("two particles of clay that pass each other lose no more in plastic work than they have") {
  for (const double damping : {0.0, 0.3, 1.0}) {
    CAPTURE(damping);
    Particles<2> P;
    P.resize(2, true, false);
    const double x[2] = {3.0625, 3.9625}, y[2] = {0.5925, 0.9625}, vx[2] = {3.0, -3.0}, vy[2] = {0.0, -2.0};
    for (std::size_t p = 0; p < 2; ++p) {
      P.position[0][p] = x[p];
      P.position[1][p] = y[p];
      P.velocity[0][p] = vx[p];
      P.velocity[1][p] = vy[p];
      P.volume[p] = 0.25 * h * h;
      P.mass[p] = 1900.0 * P.volume[p];
      P.strength[p] = 3000.0;
      P.identity[p] = static_cast<std::int32_t>(p);
    }
    // J, of the motion against each other.
    const double most = 0.25 * P.mass[0] * (6.0 * 6.0 + 2.0 * 2.0), start = kinetic_energy(P);
    SolverOptions o;
    o.transfer_damping = o.flow_transfer_damping = damping;
    const Terrain none;
    const auto s = make_solver<2>(o, h, {}, std::move(P), {clay(5e6, 3000.0)}, none, Walls<2>{});
    s->start(1e30);
    for (double t = 0.0; t < 0.4;) {
      t += s->step({}, {}, 1e30).dt;
      // In the first step particles take affine velocities from the grid beside what they have, as if they had begun
      // with them. Undamped, these stay.
      const double own = damping > 0.0 ? 0.005 : 0.03;
      CHECK(kinetic_energy(s->particles()) + s->elastic_energy() + s->work().plastic < start * (1.0 + own));
    }
    CHECK(s->work().plastic > 20.0);
    CHECK(s->work().plastic < most);
  }
}

TEST_CASE("phi = 0 soil is damped by the one number, soil that keeps its shape by the other") {
  const auto after = [](const char* law, double damping, double of_flow) {
    Particles<2> P;
    P.resize(2, true, false);
    for (std::size_t p = 0; p < 2; ++p) {
      P.position[0][p] = 3.0 + 0.1 * static_cast<double>(p);
      P.position[1][p] = 3.1;
      P.velocity[0][p] = p == 0 ? 1.0 : -0.5;
      P.volume[p] = 0.25 * h * h;
      P.mass[p] = 1900.0 * P.volume[p];
      P.strength[p] = 3000.0;
      P.identity[p] = static_cast<std::int32_t>(p);
    }
    Material soil = clay(5e6, 3000.0);
    soil.law = &law_named(law);
    SolverOptions o;
    o.transfer_damping = damping;
    o.flow_transfer_damping = of_flow;
    const Terrain none;
    const auto s = make_solver<2>(o, h, {}, std::move(P), {soil}, none, Walls<2>{});
    s->start(1e30);
    for (int n = 0; n < 5; ++n) s->step({}, {}, 1e30);
    return s->particles().velocity[0][0];
  };
  CHECK(after("tresca", 0.3, 0.05) == after("tresca", 0.9, 0.05));
  CHECK(after("tresca", 0.3, 0.05) != after("tresca", 0.3, 0.3));
  CHECK(after("linear_elastic", 0.3, 0.05) == after("linear_elastic", 0.3, 0.3));
  CHECK(after("linear_elastic", 0.3, 0.05) != after("linear_elastic", 0.9, 0.05));
}

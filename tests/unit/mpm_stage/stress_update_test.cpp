#include "mpm_stage/material/stress_update.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "mpm_stage/transfer/grid_to_particles.hpp"

using namespace tailrun::mpm;

namespace {

Particles<2> one_particle(std::array<double, 4> stress) {
  Particles<2> P;
  P.resize(1, true, false);
  P.mass[0] = 2000.0;
  P.volume[0] = 1.0;
  P.strength[0] = 1e12;
  for (int k = 0; k < 4; ++k) P.stress[k][0] = stress[k];
  return P;
}

MaterialConstants elastic(const char* law = "linear_elastic") {
  Material m;
  m.law = &law_named(law);
  m.youngs_modulus = 1e7;
  m.poisson_ratio = 0.3;
  m.friction_angle = 30.0;
  return constants_of(m, 1.0);
}

// Cohesionless where the particle's strength is zero.
MaterialConstants sand(PorePressure pore_pressure) {
  Material m;
  m.law = &law_named("mohr_coulomb");
  m.youngs_modulus = 5e7;
  m.poisson_ratio = 0.3;
  m.friction_angle = 34.0;
  m.pore_pressure = pore_pressure;
  return constants_of(m, 1.0);
}

void update(const MaterialConstants& k, Particles<2>& P, const std::array<double, 4>& A, double dt) {
  const auto G = midpoint_gradient(A);
  for (int i = 0; i < 4; ++i) P.gradient[i][0] = G[i];
  const double trace = G[0] + G[3];
  update_stress(k, P, 0, 1, &trace, dt);
}

}  // namespace

TEST_CASE("a rigid turn of 90 degrees in steps turns the stress and adds none") {
  Particles<2> P = one_particle({-3e4, 1e4, -5e3, 7e3});
  const int steps = 9;
  const double angle = M_PI / 2.0 / steps, c = std::cos(angle), s = std::sin(angle);
  for (int i = 0; i < steps; ++i) update(elastic(), P, {c - 1.0, -s, s, c - 1.0}, 1e-3);
  // Hughes & Winget turn by 2 atan(tan(angle / 2)), which is exactly the angle of the midpoint gradient's rotation.
  CHECK(P.stress[0][0] == doctest::Approx(1e4).epsilon(1e-10));
  CHECK(P.stress[1][0] == doctest::Approx(-3e4).epsilon(1e-10));
  CHECK(P.stress[2][0] == doctest::Approx(-5e3).epsilon(1e-12));
  CHECK(P.stress[3][0] == doctest::Approx(-7e3).epsilon(1e-10));
  CHECK(P.volume[0] == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("uniaxial strain gives Hooke's stresses and the exact volume") {
  Particles<2> P = one_particle({0, 0, 0, 0});
  const MaterialConstants k = elastic();
  update(k, P, {0.0, 0.0, 0.0, -1e-4}, 1e-3);
  CHECK(P.stress[1][0] == doctest::Approx(-1e-4 * (k.lambda + 2 * k.mu)).epsilon(1e-4));
  CHECK(P.stress[0][0] == doctest::Approx(-1e-4 * k.lambda).epsilon(1e-4));
  CHECK(P.stress[2][0] == doctest::Approx(P.stress[0][0]).epsilon(1e-12));
  CHECK(P.volume[0] == doctest::Approx(1.0 - 1e-4).epsilon(1e-8));
}

TEST_CASE("plane strain active yield: zz is the intermediate stress and Rankine's ratio holds") {
  Particles<2> P = one_particle({-5e4, -1e5, -5e4, 0});
  P.strength[0] = 0.0;
  for (int i = 0; i < 150; ++i) update(elastic("mohr_coulomb"), P, {2e-5, 0.0, 0.0, 0.0}, 1e-3);
  CHECK(P.stress[1][0] < -5e4);
  const double ka = (1.0 - 0.5) / (1.0 + 0.5);
  CHECK(P.stress[0][0] / P.stress[1][0] == doctest::Approx(ka).epsilon(1e-9));
  CHECK(P.stress[2][0] < P.stress[0][0]);
  CHECK(P.stress[2][0] > P.stress[1][0]);
}

TEST_CASE("Bingham: shear stress is yield stress plus viscosity times rate") {
  Material m;
  m.law = &law_named("tresca");
  m.youngs_modulus = 1e8;
  m.poisson_ratio = 0.3;
  m.rate.consistency = 50.0;
  const MaterialConstants k = constants_of(m, 1.0);
  Particles<2> P = one_particle({0, 0, 0, 0});
  P.strength[0] = 1000.0;
  const double dt = 1e-3, rate = 10.0;
  for (int i = 0; i < 50; ++i) update(k, P, {0.0, rate * dt, 0.0, 0.0}, dt);
  const double tau = std::hypot(P.stress[3][0], 0.5 * (P.stress[0][0] - P.stress[1][0]));
  CHECK(tau == doctest::Approx(1000.0 + 50.0 * rate).epsilon(1e-3));
}

TEST_CASE("softening: strength falls to its residual over the strain given") {
  Material m;
  m.law = &law_named("tresca");
  m.youngs_modulus = 1e8;
  m.poisson_ratio = 0.3;
  m.softening.active = true;
  m.softening.end_strain = 0.5;
  m.softening.cohesion_ratio = 0.4;
  const MaterialConstants k = constants_of(m, 1.0);
  Particles<2> P = one_particle({0, 0, 0, 0});
  P.strength[0] = 1e4;
  for (int i = 0; i < 3000; ++i) update(k, P, {0.0, 1e-3, 0.0, 0.0}, 1e-3);
  const double tau = std::hypot(P.stress[3][0], 0.5 * (P.stress[0][0] - P.stress[1][0]));
  CHECK(tau == doctest::Approx(4e3).epsilon(1e-6));
}

TEST_CASE("soil that opens loses its frozen pore pressure, and its work is u dV") {
  const MaterialConstants k = sand(PorePressure::frozen);
  Particles<2> P = one_particle({-5e4, -5e4, -5e4, 0.0});
  P.pore_pressure.assign(1, 8e4);
  P.strength[0] = 0.0;
  const auto expand = [&](double strain) {
    const auto G = midpoint_gradient(std::array<double, 4>{strain, 0.0, 0.0, strain});
    for (int i = 0; i < 4; ++i) P.gradient[i][0] = G[i];
    const double trace = G[0] + G[3];
    return update_stress(k, P, 0, 1, &trace, 1e-3);
  };
  // While the skeleton is in compression nothing happens to the water.
  const double to_apex = 5e4 / (2.0 * k.bulk);
  CHECK(expand(0.2 * to_apex).pore_pressure == doctest::Approx(8e4 * 2.0 * 0.2 * to_apex).epsilon(1e-3));
  CHECK(P.pore_pressure[0] == doctest::Approx(8e4));
  // Past it the total mean stress goes on elastically, at the water's cost, until nothing is left.
  const double mean = (P.stress[0][0] + P.stress[1][0] + P.stress[2][0]) / 3.0;
  const double step = (4e4 - mean) / (2.0 * k.bulk);
  expand(step);
  CHECK(P.pore_pressure[0] == doctest::Approx(4e4).epsilon(1e-3));
  for (int i = 0; i < 3; ++i) CHECK(P.stress[i][0] == doctest::Approx(0.0).scale(1e4));
  expand(step);
  CHECK(P.pore_pressure[0] == 0.0);
  CHECK(expand(0.1).pore_pressure == 0.0);
}

TEST_CASE("voids that open do not count as the soil's volume beyond its limit") {
  MaterialConstants k = sand(PorePressure::total);
  Particles<2> P = one_particle({0, 0, 0, 0});
  P.strength[0] = 0.0;
  k.largest_specific_volume = 2.0 * P.volume[0] / P.mass[0];
  for (int i = 0; i < 40; ++i) update(k, P, {0.05, 0.0, 0.0, 0.05}, 1e-3);
  CHECK(P.volume[0] == doctest::Approx(2.0).epsilon(1e-12));
}

TEST_CASE("drops of a fluid that come apart do not count the room between them as theirs") {
  Material water;
  water.law = &law_named("newtonian_fluid");
  water.bulk_modulus = 2e6;
  water.density = 1000.0;
  MaterialConstants k = constants_of(water, 1.0);
  Particles<2> P = one_particle({0, 0, 0, 0});
  k.largest_specific_volume = 1.25 * P.volume[0] / P.mass[0];
  for (int i = 0; i < 40; ++i) update(k, P, {0.05, 0.0, 0.0, 0.05}, 1e-3);
  CHECK(P.volume[0] == doctest::Approx(1.25).epsilon(1e-12));
}

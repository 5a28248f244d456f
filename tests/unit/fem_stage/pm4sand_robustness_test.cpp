// What must hold whatever the path: finite, on or inside the cone, above the stress floor, symmetric, step-independent,
// and at a bounded cost.
#include <doctest/doctest.h>

#include <cstring>
#include <random>

#include "material_drive.hpp"

using namespace tailrun::fem;
using namespace tailrun::fem::testing;

namespace {

template <class Drive>
void random_walk(Drive point, double amplitude, double volume_share, int steps, long most_substeps) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < steps; ++i) {
    const double volume = volume_share * amplitude * uniform(generator);
    const double d = amplitude * uniform(generator);
    const long done = point.step(0.5 * volume + d, 0.5 * volume - d, 2.0 * amplitude * uniform(generator));
    const Pm4Variables& v = point.state.v;
    const bool finite = std::isfinite(v.p + v.s.d + v.s.xy + v.alpha.d + v.alpha.xy + v.z.d + v.z.xy + v.z_cum);
    const bool floor = v.p >= 0.2 * point.constants.p_min * (1.0 - 1e-12);
    const bool cone = point.f() <= 1e-10 * std::max(v.p, 101.3e3);
    const bool cost = done >= 0 && done <= most_substeps;
    REQUIRE((finite && floor && cone && cost));
  }
}

}  // namespace

TEST_CASE("PM4Sand, PM4Silt: 10 000 random strain steps of up to 1e-3 stay finite, on the cone and above the floor") {
  for (const double volume : {0.0, 0.05, 0.5}) {
    random_walk(drive(tailings(), 50e3, 100e3), 1e-3, volume, 10000, 2500);
    random_walk(drive(foundation(), 50e3, 100e3), 1e-3, volume, 10000, 2500);
  }
  Pm4SiltParameters silt;
  silt.strength_ratio = 0.25;
  silt.shear_coefficient = 500.0;
  silt.contraction_rate = 20.0;
  silt.density = 1800.0;
  random_walk(drive(silt, 50e3, 100e3), 1e-3, 0.05, 10000, 2500);
}

TEST_CASE("PM4Sand: random strain steps of 1e-2 and 1e-1 end, too") {
  for (const double amplitude : {1e-2, 1e-1}) {
    random_walk(drive(tailings(), 50e3, 100e3), amplitude, 0.05, 1000, 5000);
    random_walk(drive(embankment(), 50e3, 100e3), amplitude, 1.0, 1000, 8000);
  }
}

TEST_CASE("PM4Sand compatible mode: random strain steps of 2e-4") {
  auto point = drive(as_opensees(embankment()), 50e3, 100e3);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-2e-4, 2e-4);
  for (int i = 0; i < 3000; ++i) {
    point.step(0.05 * uniform(generator), 0.05 * uniform(generator), uniform(generator));
    REQUIRE(std::isfinite(point.xx() + point.yy() + point.xy()));
    REQUIRE(point.state.v.p >= 0.2 * point.constants.p_min);
  }
}

TEST_CASE("PM4Sand: a mirrored path (shear reversed) and a rotated one (xx and yy exchanged) give mirrored stresses") {
  for (const bool opensees : {true, false}) {
    const Pm4SandParameters p = opensees ? as_opensees(embankment()) : embankment();
    auto plain = drive(p, 50e3, 100e3), mirrored = drive(p, 50e3, 100e3), rotated = drive(p, 100e3, 50e3);
    for (int i = 0; i < 4000; ++i) {
      const double x = 1e-6 * std::sin(0.01 * i), y = 2e-6 * std::cos(0.007 * i), g = 2e-5 * std::cos(0.02 * i);
      plain.step(x, y, g);
      mirrored.step(x, y, -g);
      rotated.step(y, x, g);
    }
    CHECK(mirrored.xx() == doctest::Approx(plain.xx()).epsilon(1e-9));
    CHECK(mirrored.xy() == doctest::Approx(-plain.xy()).epsilon(1e-9));
    CHECK(rotated.xx() == doctest::Approx(plain.yy()).epsilon(1e-9));
    CHECK(rotated.yy() == doctest::Approx(plain.xx()).epsilon(1e-9));
    CHECK(rotated.xy() == doctest::Approx(plain.xy()).epsilon(1e-9));
  }
}

TEST_CASE("PM4Sand improved mode: one step and the same step in 10 or 100 parts end alike") {
  for (const double size : {1e-4, 1e-3, 1e-2}) {
    for (const double direction : {1.0, -1.0}) {
      std::vector<double> shear;
      for (const int parts : {1, 10, 100}) {
        auto point = drive(tailings(), 50e3, 100e3);
        for (int i = 0; i < 200; ++i) point.step(0.0, 0.0, 1e-6);
        for (int i = 0; i < parts; ++i) point.step(0.0, 0.0, direction * size / parts);
        shear.push_back(point.xy());
      }
      INFO("size " << size << " direction " << direction);
      CHECK(std::fabs(shear[0] - shear[2]) < 0.01 * 75e3 * 0.3);  // 0.3 % of p0
      CHECK(std::fabs(shear[1] - shear[2]) < 0.01 * 75e3 * 0.3);
    }
  }
}

TEST_CASE("PM4Sand: a trial does not touch the committed state and can be repeated") {
  for (const bool opensees : {true, false}) {
    auto point = drive(opensees ? as_opensees(loose()) : loose(), 50e3, 100e3);
    for (int i = 0; i < 500; ++i) point.step(0.0, 0.0, 2e-6);
    const Pm4State before = point.state;
    Pm4State first, second;
    const PlaneStrain strain{1e-6, {2e-5, -4e-4}};
    trial_update(point.law, point.constants, point.options, point.state, strain, first);
    trial_update(point.law, point.constants, point.options, point.state, {0.0, {0.0, 1e-3}}, second);
    trial_update(point.law, point.constants, point.options, point.state, strain, second);
    CHECK(std::memcmp(&before, &point.state, sizeof before) == 0);
    CHECK(std::memcmp(&first, &second, sizeof first) == 0);
  }
}

// Where soil flows, strain per step reaches 1e-3 to 1e-2; the peer's cost grows with it without bound.
TEST_CASE("PM4Sand improved mode: sub-steps of one update stay few in flowing soil") {
  auto point = drive(tailings(), 50e3, 100e3);
  while (point.state.v.p > 6.5e3) point.step(0.0, 0.0, 1e-4);
  for (const double size : {1e-4, 1e-3, 1e-2}) {
    Pm4State trial;
    const long onward =
        trial_update(point.law, point.constants, point.options, point.state, {0.0, {0.0, size / 2}}, trial);
    const long back =
        trial_update(point.law, point.constants, point.options, point.state, {0.0, {0.0, -size / 2}}, trial);
    CHECK(onward <= 10);
    CHECK(back <= 100);
  }
}

TEST_CASE(
    "PM4Sand: at the stress floor the improved reset keeps the direction of shear, OpenSees' forces it positive") {
  Pm4Law law;
  law.M = 1.0;
  Pm4PointConstants point;
  point.p_min = 500.0;
  Pm4Variables v;
  v.p = 10.0;
  v.s = {30.0, -40.0};
  Pm4Variables improved = v, peer = v;
  CHECK(hold_stress_floor(law, point, improved));
  CHECK(improved.p == doctest::Approx(100.0));
  CHECK(improved.s.xy / improved.s.d == doctest::Approx(-40.0 / 30.0));
  law.compatibility = Pm4Compatibility::opensees;
  CHECK(hold_stress_floor(law, point, peer));
  CHECK(peer.s.d == 0.0);
  CHECK(peer.s.xy == doctest::Approx(0.8 * 100.0));
}

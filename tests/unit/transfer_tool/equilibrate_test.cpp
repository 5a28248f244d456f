#include "transfer_tool/balance/equilibrate.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/error.hpp"

using tailrun::ParticleSet;
using tailrun::transfer::equilibrate;

namespace {

constexpr double gravity = 9.81, density = 2000.0, depth = 8.0, pressure_share = 0.4;

// A level layer, 16 m wide and 8 m deep on a bed between two walls, four points in each 1 m cell: sigma_yy = -(1 - x)
// gamma d, u = x gamma d and a third of the effective stress sideways. `rough` (Pa) is added to the mean stress of
// squares of 2 m and taken off their neighbours.
ParticleSet layer(double rough) {
  ParticleSet set;
  set.terrain = {{"bed", {0, 0, 16, 0}}, {"upstream_wall", {0, 10, 0, 0}}, {"downstream_wall", {16, 0, 16, 10}}};
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 16; ++j) {
      const double x = 0.25 + 0.5 * i, y = 0.25 + 0.5 * j, weight = density * gravity * (depth - y);
      const double bump = (i / 4 + j / 4) % 2 == 0 ? rough : -rough;
      const double vertical = -(1.0 - pressure_share) * weight;
      set.position.insert(set.position.end(), {x, y, 0.0});
      set.mass.push_back(density * 0.25);
      set.volume.push_back(0.25);
      set.pore_pressure.push_back(pressure_share * weight);
      set.effective_stress.insert(set.effective_stress.end(),
                                  {vertical / 3.0 + bump, vertical + bump, vertical / 3.0, 0.0});
    }
  return set;
}

}  // namespace

TEST_CASE("a layer in balance is left as it is") {
  ParticleSet set = layer(0.0);
  const auto balance = equilibrate(set, 1.0, gravity);
  CHECK(balance.before < 0.02);  // what half cells at the surface leave
  CHECK(balance.change < 1e3);   // of 80 kPa, most of it in the last half cell below the surface
}

TEST_CASE("rough stresses come into balance by a change that is smaller than their roughness") {
  ParticleSet set = layer(20e3);
  const auto szz = set.effective_stress[2];
  const auto balance = equilibrate(set, 1.5, gravity);
  CHECK(balance.before > 0.1);
  CHECK(balance.after < 0.01 * balance.before);
  CHECK(balance.change > 0.0);
  CHECK(balance.change < 20e3 * std::sqrt(2.0));  // taking the roughness away would be one way
  CHECK(set.effective_stress[2] == szz);
  CHECK(equilibrate(set, 1.5, gravity).change < 0.01 * balance.change);
}

TEST_CASE("a grid whose nodes all touch the ground is refused") {
  ParticleSet set = layer(0.0);
  CHECK_THROWS_AS(equilibrate(set, 40.0, gravity), tailrun::InputError);
}

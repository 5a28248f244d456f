#include "mpm_stage/output/front.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

// Eleven particles at x = 0 .. 10, of one soil.
Scene row_of_particles() {
  Scene scene;
  Material soil;
  soil.name = "soil";
  soil.law = &law_named("tresca");
  scene.materials = {soil};
  scene.particles.material_names = {"soil"};
  for (int i = 0; i <= 10; ++i) {
    for (const double x : {static_cast<double>(i), 1.0, 0.0}) scene.particles.position.push_back(x);
    scene.particles.mass.push_back(100.0);
    scene.particles.material_id.push_back(0);
  }
  return scene;
}

Particles<2> solver_row() {
  Particles<2> P;
  P.resize(11, true, false);
  for (int i = 0; i <= 10; ++i) {
    const auto p = static_cast<std::size_t>(i);
    P.position[0][p] = i;
    P.position[1][p] = 1.0;
    P.mass[p] = 100.0;
    P.identity[p] = i;
  }
  return P;
}

}  // namespace

TEST_CASE("the flow's front is that of the soil which moved, not of what stands ahead of it") {
  const Scene scene = row_of_particles();
  FrontSeries<2> front(scene);
  Particles<2> P = solver_row();
  CHECK(std::isnan(front.sample(0.0, P).flow_front));
  P.position[0][3] += 2.0;
  P.position[0][4] += 0.5;  // less than flow_distance
  const FrontRow& row = front.sample(1.0, P);
  CHECK(row.flow_front == doctest::Approx(5.0));
  CHECK(row.flowed_mass == doctest::Approx(100.0));
  CHECK(row.front == doctest::Approx(10.0));
}

TEST_CASE("one straggler does not make the robust front") {
  Scene scene = row_of_particles();
  scene.output.front_quantile = 0.85;
  FrontSeries<2> front(scene);
  Particles<2> P = solver_row();
  P.position[0][10] = 500.0;
  const FrontRow& row = front.sample(0.0, P);
  CHECK(row.front == doctest::Approx(500.0));
  CHECK(row.robust_front == doctest::Approx(9.0));
}

#include "mpm_stage/output/front.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

// Eleven particles at x = 0 .. 10, of one soil.
Scene row_of_particles() {
  Scene scene;
  scene.cell_size = 1.0;
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

TEST_CASE("runout is measured from the toe before the motion to what has flowed; short of the toe it is negative") {
  Scene scene = row_of_particles();
  for (int i = 0; i <= 10; ++i)
    scene.particles.displacement.insert(scene.particles.displacement.end(), {0.5, 0.0, 0.0});
  FrontSeries<2> front(scene);
  CHECK(front.toe() == doctest::Approx(9.5));
  Particles<2> P = solver_row();
  CHECK(std::isnan(front.sample(0.0, P).flow_front));
  P.position[0][3] += 2.0;  // flows, and stays on the dam
  CHECK(front.runout(front.sample(1.0, P)) == doctest::Approx(5.0 - 9.5));
  P.position[0][3] += 20.0;
  CHECK(front.runout(front.sample(2.0, P)) == doctest::Approx(25.0 - 9.5));
}

TEST_CASE("a drop far ahead makes the flow's front and not the runout; soil that hangs together does, or the body") {
  Scene scene = row_of_particles();
  scene.output.body_quantile = 0.7;
  FrontSeries<2> front(scene);
  Particles<2> P = solver_row();
  for (std::size_t p = 3; p <= 10; ++p) P.position[0][p] += 7.0;  // 10 .. 17, without gaps
  CHECK(front.runout(front.sample(1.0, P)) == doctest::Approx(17.0 - 10.0));
  P.position[0][10] = 5000.0;
  const FrontRow& drop = front.sample(2.0, P);
  CHECK(front.runout(drop.flow_front) == doctest::Approx(5000.0 - 10.0));
  CHECK(front.runout(drop) == doctest::Approx(16.0 - 10.0));
  // A third of the flow far off: the body goes with it.
  P.position[0][8] = 550.0;
  P.position[0][9] = 600.0;
  const FrontRow& torn = front.sample(3.0, P);
  CHECK(front.runout(torn) == doctest::Approx(front.runout(torn.flow_body)));
  CHECK(front.runout(torn.flow_body) > front.runout(torn.coherent_front));
}

TEST_CASE("nothing that flowed has no runout") {
  FrontSeries<2> front(row_of_particles());
  CHECK(std::isnan(front.runout(front.sample(0.0, solver_row()))));
}

TEST_CASE("a flow towards smaller coordinates has its toe there, and the case may say where the toe is") {
  Scene scene = row_of_particles();
  scene.output.front_sign = -1.0;
  FrontSeries<2> front(scene);
  CHECK(front.toe() == doctest::Approx(0.0));
  Particles<2> P = solver_row();
  P.position[0][2] -= 7.0;
  CHECK(front.runout(front.sample(1.0, P)) == doctest::Approx(5.0));
  scene.output.toe = 4.0;
  CHECK(FrontSeries<2>(scene).toe() == 4.0);
}

TEST_CASE("quantiles are of the mass that flowed") {
  Ahead flowed;
  for (int i = 0; i < 100; ++i) flowed.emplace_back(i, i < 90 ? 1.0 : 9.0);  // 180 kg, half of them beyond 90 m
  put_foremost_first(flowed);
  CHECK(quantile_front(flowed, 1.0) == 99.0);
  CHECK(quantile_front(flowed, 0.9) == 98.0);
  CHECK(quantile_front(flowed, 0.5) == 90.0);
  CHECK(std::isnan(quantile_front({}, 0.5)));
}

TEST_CASE("the coherent front ends at the first gap; standing soil bridges one") {
  const Ahead flowed = {{900.0, 1.0}, {13.0, 1.0}, {12.2, 1.0}, {8.5, 1.0},
                        {8.0, 1.0},   {7.5, 1.0},  {7.0, 1.0},  {6.0, 1.0}};
  CHECK(coherent_front(flowed, flowed, 1.0) == doctest::Approx(8.5));
  Ahead all = flowed;
  for (const double x : {9.4, 10.3, 11.25}) all.emplace_back(x, 1.0);
  CHECK(coherent_front(all, flowed, 1.0) == doctest::Approx(13.0));
  CHECK(std::isnan(coherent_front(all, {}, 1.0)));
}

TEST_CASE("ground is the highest coherent soil over the footprint, not a particle in the air or outside") {
  const auto ground = [](const std::vector<std::array<double, 2>>& points) {
    GroundOverFootprint measure(2, 0, {0.0, 4.0}, 1.0);
    return measure(points.size(), [&](std::size_t p, int d) { return points[p][static_cast<std::size_t>(d)]; });
  };
  CHECK(ground({{0.5, 1.0}, {0.5, 1.9}, {0.4, 3.0}, {1.5, 1.5}, {7.0, 9.0}}) == doctest::Approx(1.9));
  CHECK(ground({{3.5, 2.5}, {0.5, 1.0}}) == doctest::Approx(2.5));
  CHECK(std::isnan(ground({{7.0, 9.0}})));
}

TEST_CASE("in 3-D the lowest strip along the flow is the ground that is left") {
  const std::vector<std::array<double, 3>> points = {
      {0.5, 5.0, 0.5}, {1.5, 2.0, 0.5}, {0.5, 1.0, 1.5}, {1.5, 3.0, 1.5}};
  GroundOverFootprint measure(3, 0, {0.0, 4.0}, 1.0);
  CHECK(measure(points.size(), [&](std::size_t p, int d) { return points[p][static_cast<std::size_t>(d)]; }) ==
        doctest::Approx(3.0));
}

TEST_CASE(
    "the footprint reaches from the crest to the toe, unless it is given, and freeboard follows the ground there") {
  Scene scene = row_of_particles();
  scene.particles.position[3 * 4 + 1] = 3.0;  // the crest, at x = 4
  FrontSeries<2> front(scene);
  CHECK(front.footprint() == std::array<double, 2>{4.0, 10.0});
  CHECK(front.ground_before() == doctest::Approx(3.0));
  Particles<2> P = solver_row();
  CHECK(front.sample(0.0, P).ground == doctest::Approx(1.0));
  scene.output.footprint = {{0.0, 2.0}};
  CHECK(FrontSeries<2>(scene).ground_before() == doctest::Approx(1.0));
}

TEST_CASE("a flow is over when little of its energy is left and its front is slow, however long some soil creeps") {
  Scene scene = row_of_particles();
  scene.rest.energy_share = 0.01;
  scene.rest.duration = 1.0;
  Particles<2> P = solver_row();
  // All at `speed`, and the front at x; a sample every half second.
  FrontSeries<2> front(scene);
  double time = 0.0;
  const auto sample = [&](FrontSeries<2>& series, double speed, double x) {
    for (double& v : P.velocity[0]) v = speed;
    P.position[0][10] = x;
    series.sample(time, P);
    time += 0.5;
    return series.flow_is_over(scene.rest);
  };
  CHECK(!sample(front, 0.0, 10.0));
  CHECK(!sample(front, 10.0, 20.0));  // 10 m/s
  CHECK(!sample(front, 10.0, 25.0));
  CHECK(!sample(front, 10.0, 30.0));
  CHECK(!sample(front, 0.99, 31.5));  // 11 m/s over the last second
  CHECK(!sample(front, 0.99, 33.0));  // energy has been low for half a second, the front is fast
  CHECK(!sample(front, 0.99, 34.5));
  CHECK(!sample(front, 0.99, 34.6));
  SUBCASE("over") {
    CHECK(sample(front, 0.99, 34.7));
  }
  SUBCASE("a tongue runs on") {
    CHECK(!sample(front, 0.99, 36.0));
  }
  SUBCASE("a second pulse") {
    CHECK(!sample(front, 2.0, 34.7));
  }
  SUBCASE("not asked for") {
    scene.rest.energy_share = 0.0;
    CHECK(!sample(front, 0.99, 34.7));
  }
  SUBCASE("gone on with from a checkpoint") {
    FrontSeries<2> again(scene);
    again.restore(front.rows());
    CHECK(sample(again, 0.99, 34.7));
  }
}

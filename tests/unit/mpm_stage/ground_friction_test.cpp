#include <doctest/doctest.h>

#include <cmath>

#include "mpm_stage/boundary/ground_friction.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

// Displacement (m) along a plane of `angle` (deg) between 0.3 and 0.8 s of a stiff block of 4 x 1 m, and the speed that
// it had at 0.3 s.
struct Slide {
  double distance, speed;
};

Slide slide_of_block(double angle, double friction) {
  constexpr double h = 0.25, spacing = 0.5 * h, density = 2000.0, k0 = 0.42857;
  const double b = angle * M_PI / 180.0, c = std::cos(b), s = std::sin(b);
  Particles<2> P;
  P.resize(32 * 8, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double x = (static_cast<double>(p % 32) + 0.5) * spacing, y = (static_cast<double>(p / 32) + 0.5) * spacing;
    P.position[0][p] = c * x + s * y;
    P.position[1][p] = -s * x + c * y;
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
    // Infinite slope: stress normal to it from the weight above, shear as far as friction allows.
    const double normal = -density * 9.81 * c * (1.0 - y), along = k0 * normal;
    const double shear = -std::min(friction, s / c) * normal;
    P.stress[0][p] = along * c * c + normal * s * s + 2.0 * shear * c * s;
    P.stress[1][p] = along * s * s + normal * c * c - 2.0 * shear * c * s;
    P.stress[2][p] = along;
    P.stress[3][p] = (normal - along) * c * s + shear * (c * c - s * s);
  }
  Material rock;
  rock.name = "rock";
  rock.law = &law_named("linear_elastic");
  rock.youngs_modulus = 1e9;
  rock.poisson_ratio = 0.3;
  Terrain plane;
  plane.add_line({{{-100.0 * c, 100.0 * s}}, {{100.0 * c, -100.0 * s}}}, {friction}, false);
  auto solver = make_solver<2>({}, h, {}, std::move(P), {rock}, plane, Walls<2>{});
  solver->start(1e30);
  const auto mean = [&](const auto& column) {
    double sum = 0.0;
    for (std::size_t p = 0; p < solver->particles().count(); ++p) sum += c * column[0][p] - s * column[1][p];
    return sum / static_cast<double>(solver->particles().count());
  };
  double time = 0.0;
  while (time < 0.3) time += solver->step({0, -9.81}, {0, 0}, 1e30).dt;
  const double start = mean(solver->particles().position), speed = mean(solver->particles().velocity), from = time;
  while (time < 0.8) time += solver->step({0, -9.81}, {0, 0}, 1e30).dt;
  return {mean(solver->particles().position) - start - speed * (time - from - 0.5), speed};
}

}  // namespace

TEST_CASE("a ringing block stays where it is on 96 and 98 % of its friction") {
  CHECK(std::fabs(slide_of_block(30.0, 0.6).distance) < 0.001 * 0.25);
  CHECK(std::fabs(slide_of_block(19.0, 0.35).distance) < 0.001 * 0.25);
}

TEST_CASE("a sliding block loses friction times its weight on the plane, no more and no less") {
  const double b = 35.0 * M_PI / 180.0, a = 9.81 * (std::sin(b) - 0.6 * std::cos(b));
  const Slide slide = slide_of_block(35.0, 0.6);
  CHECK(slide.speed == doctest::Approx(0.3 * a).epsilon(0.02));
  CHECK(slide.distance == doctest::Approx(0.5 * slide.speed + 0.5 * a * 0.25).epsilon(0.01));
}

TEST_CASE("a node remembers its push for the time of a wave through 7 cells, and not where it slides fast") {
  NodeContact contact;
  contact.count = 1;
  contact.point[0] = {};
  contact.point[0].normal = {0.0, 1.0};
  constexpr double mass = 3.0, dt = 0.01, wave = 0.5;  // cells a step
  const auto remembered = [&](double slip, int steps) {
    double smoothed = 2.0;
    NodeGrip grip;
    for (int i = 0; i < steps; ++i) {
      grip = {mass, 6.0 * mass * dt, {0.0, 1.0}};  // pushed three times as hard from now on
      smooth_grip(contact, mass, dt, smoothing_share(wave, slip), smoothed, grip);
    }
    return grip.friction / (mass * dt);
  };
  CHECK(remembered(0.0, 14) == doctest::Approx(6.0 - 4.0 * std::pow(1.0 - 0.5 / 7.0, 14)));
  CHECK(remembered(0.004 * wave, 7) == doctest::Approx(6.0 - 4.0 * std::pow(1.0 - 1.0 / 7.0, 7)));
  CHECK(remembered(0.02 * wave, 1) == 6.0);
}

namespace {

struct Slab {
  double speed = 3.0, strength = 8000.0, slope = 0.0, end = 0.3;  // m/s, Pa, rad, s
  bool limited = true;
};

// Mean velocity (m/s) at the end of a slab of clay, 8 x 1 m, that slides over ground that could hold 2 g, in 2-D or, as
// a slice between mirrors, in 3-D. The slope is one of gravity; the slab starts without the shear stress that it asks
// for.
template <int Dim>
double speed_of(const Slab& slab) {
  constexpr double h = 0.25, spacing = 0.5 * h, density = 2000.0;
  constexpr int layers = Dim == 3 ? 4 : 1;
  Particles<Dim> P;
  P.resize(64 * 8 * layers, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = (static_cast<double>(p % 64) + 0.5) * spacing;
    P.position[1][p] = (static_cast<double>(p / 64 % 8) + 0.5) * spacing;
    if constexpr (Dim == 3) P.position[2][p] = (static_cast<double>(p / 512) + 0.5) * spacing;
    P.velocity[0][p] = slab.speed;
    P.volume[p] = std::pow(spacing, Dim);
    P.mass[p] = density * P.volume[p];
    P.strength[p] = slab.strength;
    P.identity[p] = static_cast<std::int32_t>(p);
    P.stress[1][p] = -density * 9.81 * (1.0 - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = 0.5 * P.stress[1][p];
  }
  Material clay;
  clay.name = "clay";
  clay.law = &law_named("tresca");
  clay.youngs_modulus = 5e6;
  clay.poisson_ratio = 0.33;
  Terrain ground;
  ground.add_line({{{-100.0, 0.0}}, {{100.0, 0.0}}}, {2.0}, false);
  Walls<Dim> walls;
  std::array<double, Dim> origin{}, gravity{};
  gravity[0] = 9.81 * std::sin(slab.slope);
  gravity[1] = -9.81 * std::cos(slab.slope);
  if constexpr (Dim == 3) {
    walls.bounded = true;
    walls.low = {-5.0, -5.0, 0.0};
    walls.high = {20.0, 5.0, 2.0 * h};
    walls.side[2][0].kind = walls.side[2][1].kind = WallKind::slip;
  }
  SolverOptions options;
  options.soil_limits_friction = slab.limited;
  auto solver = make_solver<Dim>(options, h, origin, std::move(P), {clay}, ground, walls);
  solver->start(1e30);
  double time = 0.0, speed = 0.0;
  while (time < slab.end) time += solver->step(gravity, {}, 1e30).dt;
  for (const double v : solver->particles().velocity[0]) speed += v / static_cast<double>(solver->particles().count());
  return speed;
}

}  // namespace

TEST_CASE("rough ground brakes clay with the clay's strength: 4 m/s2, and more only by its ends") {
  // 8 kPa / (2000 kg/m3 1 m)
  const auto braking = [](double speed) { return (3.0 - speed) / 0.3; };
  const double plane = braking(speed_of<2>({})), slice = braking(speed_of<3>({}));
  CHECK(plane > 3.9);
  CHECK(plane < 4.4);
  CHECK(slice == doctest::Approx(plane).epsilon(0.02));
  CHECK(braking(speed_of<2>({.limited = false})) > 1.1 * plane);
}

TEST_CASE("a slope of clay with a factor of safety of 1.1 comes to rest, and one of 0.6 does not") {
  const double slope = 12.0 * M_PI / 180.0, needed = 2000.0 * 9.81 * std::sin(slope);
  Slab slab{.speed = 0.0, .strength = 1.1 * needed, .slope = slope, .end = 6.0};
  CHECK(std::fabs(speed_of<2>(slab)) < 0.005);
  slab.strength = 0.6 * needed;
  slab.end = 1.0;  // later it has spread, and its ends hold it
  CHECK(speed_of<2>(slab) > 0.3);
}

TEST_CASE("nodes in contact stand for all of the ground's surface, whatever its angle to the grid") {
  for (const double angle : {0.0, 0.3, 0.785, 1.2}) {
    constexpr double h = 0.5;
    const double c = std::cos(angle), s = std::sin(angle);
    Terrain ground;
    ground.add_line({{{-50.0 * c, -50.0 * s}}, {{0.0, 0.0}}, {{50.0 * c, 50.0 * s}}}, {0.5, 0.5}, false);
    Particles<2> P;
    P.resize(2001, false, false);
    for (std::size_t p = 0; p < P.count(); ++p) {
      P.position[0][p] = 0.01 * (static_cast<double>(p) - 1000.0) * c;  // 20 m along the ground
      P.position[1][p] = 0.01 * (static_cast<double>(p) - 1000.0) * s;
      P.volume[p] = P.mass[p] = 1.0;
    }
    BlockGrid<2> grid(h, {}, QuadraticShape::shift);
    grid.sort(P);
    ContactNodes<2> nodes(ground, 0.5 * h);
    nodes.update(grid);
    double within = 0.0, distance_of_others = 1e30;
    for (std::size_t a = 0; a < grid.active(); ++a) {
      if (!nodes.of_block(a)) continue;
      for (int n = 0; n < Block<2>::nodes; ++n) {
        const auto index = grid.node_index(a, n);
        const double along = h * (index[0] * c + index[1] * s), surface = nodes.surfaces(a)[n].whole;
        if (std::fabs(along) < 5.0) within += surface;
        if (surface == 0.0) distance_of_others = std::min(distance_of_others, std::fabs(nodes.distances(a)[n]));
      }
    }
    CHECK(within == doctest::Approx(10.0).epsilon(0.06));  // nodes stand for ground up to a cell beside them
    CHECK(distance_of_others > 0.3 * h);
  }
}

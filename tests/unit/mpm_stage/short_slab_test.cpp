// A slab of phi = 0 soil is held by its cohesion times its own length, on the ground and on other soil.
#include <doctest/doctest.h>

#include <cmath>

#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double g = 9.81, density = 1870.0, h = 0.5, spacing = 0.25, safety = 0.8, slope = 50.0 * M_PI / 180.0;

Material soil_of(const char* law, double stiffness) {
  Material m;
  m.name = law;
  m.law = &law_named(law);
  m.youngs_modulus = stiffness;
  m.poisson_ratio = 0.33;
  return m;
}

// m/s2, of a slab 12 cells long and 1.5 m thick under gravity tilted by 50 degrees, whose cohesion is 0.8 times what
// that asks for: between 0.4 s, when it slides all over, and 0.8 s. Its bed is the ground, or three cells of firm soil.
double acceleration(bool on_soil) {
  constexpr std::size_t wide = 24, high = 6, bed_wide = 80, bed_high = 6;
  const double thickness = high * spacing, depth = on_soil ? bed_high * spacing : 0.0;
  Particles<2> P;
  P.resize(wide * high + (on_soil ? bed_wide * bed_high : 0), true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const bool slab = p < wide * high;
    const std::size_t k = slab ? p : p - wide * high, row = slab ? wide : bed_wide;
    const double up = (static_cast<double>(k / row) + 0.5) * spacing - (slab ? 0.0 : depth);
    P.position[0][p] = (static_cast<double>(k % row) + 0.5) * spacing + (slab ? 6.0 : 0.0);
    P.position[1][p] = up;
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.material[p] = slab ? 0 : 1;
    P.strength[p] = slab ? safety * density * g * thickness * std::sin(slope) : 0.0;
    P.identity[p] = static_cast<std::int32_t>(p);
    for (int d = 0; d < 3; ++d) P.stress[d][p] = slab ? -density * g * std::cos(slope) * (thickness - up) : 0.0;
  }
  SolverOptions o;
  if (on_soil) {
    o.fields.of_material = {1, 0};
    o.fields.count = 2;
    o.fields.flows = {0, 1};
  }
  Terrain bed;
  bed.add_line({{{-1000.0, -depth}}, {{1000.0, -depth}}}, {10.0}, on_soil);
  const auto solver =
      make_solver<2>(o, h, {}, std::move(P), {soil_of("tresca", 5e6), soil_of("linear_elastic", 1e8)}, bed, Walls<2>{});
  solver->start(1e300);
  double time = 0.0;
  const auto speed_at = [&](double end) {
    while (time < end) time += solver->step({g * std::sin(slope), -g * std::cos(slope)}, {}, 1e300).dt;
    double momentum = 0.0, mass = 0.0;
    const Particles<2>& Q = solver->particles();
    for (std::size_t p = 0; p < Q.count(); ++p)
      if (Q.material[p] == 0) {
        momentum += Q.mass[p] * Q.velocity[0][p];
        mass += Q.mass[p];
      }
    return momentum / mass;
  };
  const double first = speed_at(0.4), since = time;
  return (speed_at(0.8) - first) / (time - since);
}

}  // namespace

TEST_CASE("a slab of twelve cells slides with what its cohesion times its own length leaves") {
  const double wanted = (1.0 - safety) * g * std::sin(slope);
  CHECK(acceleration(false) == doctest::Approx(wanted).epsilon(0.08));  // 0.3 of it with whole nodes for its ground
  CHECK(acceleration(true) == doctest::Approx(wanted).epsilon(0.08));   // 0.8 of it with the bed's whole surface
}

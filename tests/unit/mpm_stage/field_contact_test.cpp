#include "mpm_stage/boundary/field_contact.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <random>

#include "mpm_stage/grid/field_sides.hpp"
#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.5, dt = 1e-3;
const HalfSpaces<QuadraticShape> half;

// A body as it moves, with its shape.
struct Body : BodyAtNode<2> {
  BodyShape<2> shape;
};

ContactPair<2> between(Body& i, Body& j, const FieldContactLaw& law) {
  return ContactPair<2>(i, j, ContactSurface<2>(i.shape, j.shape, h, half), law, dt);
}

// Two half-spaces that meet in the plane x = 0 through the node.
Body side(double sign, double mass, std::array<double, 2> v, double strength) {
  Body body;
  body.mass = mass;
  body.v = body.before = v;
  body.shape.volume = 0.5 * h * h;
  body.shape.centre = {0.5 * sign * h * half.centres_apart(0.5), 0.0};
  body.shape.surface = {-sign * h * half.slice(0.5), 0.0};
  body.shape.strength = strength;
  const auto all = static_cast<std::uint32_t>(InterfaceNode::Line::below(24));
  body.shape.cover = {sign < 0.0 ? all & 0xfff : all & ~0xfffU, all, 0};
  return body;
}

// Friction of a node that has no others around it. Returns the work that it takes, J.
double rub(const ContactPair<2>& pair, BodyAtNode<2>& i, BodyAtNode<2>& j) {
  FieldGrip<2> grip = pair.grip();
  if (!grip.any()) return 0.0;
  const std::array<double, 2> slide = sliding_of<2>(grip, {i.v[0] - j.v[0], i.v[1] - j.v[1]});
  const double speed = std::hypot(slide[0], slide[1]);
  if (speed == 0.0) return 0.0;
  grip.sliding = grip.reduced_mass() * speed;
  const double impulse = std::min({grip.sliding, grip.friction, grip.carried});
  for (int d = 0; d < 2; ++d) {
    i.v[d] -= impulse / i.mass * slide[d] / speed;
    j.v[d] += impulse / j.mass * slide[d] / speed;
  }
  return impulse * std::max(0.0, speed - impulse / grip.reduced_mass());
}

double energy(const BodyAtNode<2>& b) {
  return 0.5 * b.mass * (b.v[0] * b.v[0] + b.v[1] * b.v[1]);
}

}  // namespace

TEST_CASE("half-spaces: centres, offset and slice are those of the quadratic B-spline") {
  CHECK(half.centres_apart(0.5) == doctest::Approx(0.8125).epsilon(1e-3));
  CHECK(half.slice(0.5) == doctest::Approx(0.75).epsilon(1e-3));
  CHECK(half.offset(0.5) == doctest::Approx(0.0).epsilon(1e-3));
  // The plane at half a cell: 1 / 6 of the weight lies beyond.
  CHECK(half.offset(1.0 / 6.0) == doctest::Approx(-0.5).epsilon(0.01));
  CHECK(half.offset(5.0 / 6.0) == doctest::Approx(0.5).epsilon(0.01));
}

TEST_CASE("contact between two fields keeps momentum and takes energy, whatever meets") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-1.0, 1.0), mass(1e-3, 10.0);
  for (int k = 0; k < 1000; ++k) {
    auto i = side(-1.0, mass(random), {some(random), some(random)}, 1e4 * (1.0 + some(random)));
    auto j = side(1.0, mass(random), {some(random), some(random)}, no_soil_limit);
    i.shape.centre[1] = 0.2 * h * some(random);
    i.shape.firm = k % 3 == 0;
    j.shape.firm = k % 2 == 0;
    const FieldContactLaw law{k % 5 == 0 ? 0.4 : -1.0, k % 7 == 0 ? Opening::held : Opening::free};
    const std::array<double, 2> before = {i.mass * i.v[0] + j.mass * j.v[0], i.mass * i.v[1] + j.mass * j.v[1]};
    const double start = energy(i) + energy(j);
    ContactPair<2> pair = between(i, j, law);
    pair.press();
    const double pressed = energy(i) + energy(j);
    CHECK(pressed <= start * (1.0 + 1e-14));
    const double work = rub(pair, i, j);
    CHECK(work >= 0.0);
    CHECK(energy(i) + energy(j) <= pressed - work + 1e-14 * start);
    for (int d = 0; d < 2; ++d) CHECK(i.mass * i.v[d] + j.mass * j.v[d] == doctest::Approx(before[d]).epsilon(1e-12));
  }
}

TEST_CASE(
    "of a bed askew to the grid all counts that a half-space lies on, also at nodes that see but a corner of it") {
  using Line = InterfaceNode::Line;
  for (const double share : {0.5, 0.8, 0.95}) {
    CAPTURE(share);
    const double slope = std::sqrt(0.5), offset = half.offset(share), surface = h * half.slice(share);
    BodyShape<2> bed, soil;
    bed.firm = true;
    bed.volume = share * h * h;
    soil.volume = (1.0 - share) * h * h;
    bed.surface = bed.outward = {slope * surface, slope * surface};
    soil.surface = {-slope * surface, -slope * surface};
    bed.faces = surface;
    bed.strength = no_soil_limit;
    soil.strength = 5e3;
    soil.centre = {slope * h, slope * h};
    bed.centre = {-0.1 * h, -0.1 * h};
    // The soil's bins: those that it reaches somewhere between the node's upper and lower end.
    const double from = offset / slope - Line::reach;
    const auto bins = static_cast<std::uint32_t>(
        Line::below(24) & ~Line::below(static_cast<int>(std::max(0.0, std::round((from + Line::reach) * 8.0)))));
    soil.cover = {bins, bins, 0};
    CHECK(ContactSurface<2>(bed, soil, h, half).area() / surface == doctest::Approx(1.0).epsilon(0.05));
    soil.cover = {};
    CHECK(ContactSurface<2>(bed, soil, h, half).area() == 0.0);
  }
}

TEST_CASE("phi = 0 soil brakes by its strength times the surface, and not at all across a gap") {
  const double strength = 5e3, area = h * half.slice(0.5);
  auto weak = side(-1.0, 1e3, {0.0, 1.0}, strength), strong = side(1.0, 1e9, {0.0, 0.0}, no_soil_limit);
  strong.shape.firm = true;
  ContactPair<2> pair = between(weak, strong, {});
  pair.press();
  rub(pair, weak, strong);
  CHECK(weak.v[1] == doctest::Approx(1.0 - dt * strength * area / 1e3).epsilon(1e-6));

  auto half_as_wide = side(-1.0, 1e3, {0.0, 1.0}, strength);
  half_as_wide.shape.cover[1] = 0xfff;
  ContactPair<2> at_its_end = between(half_as_wide, strong, {});
  at_its_end.press();
  rub(at_its_end, half_as_wide, strong);
  CHECK(half_as_wide.v[1] == doctest::Approx(1.0 - 0.5 * dt * strength * area / 1e3).epsilon(1e-6));

  auto apart = side(-1.0, 1e3, {0.1, 1.0}, strength);
  apart.shape.centre[0] -= 0.5 * h;
  ContactPair<2> open = between(apart, strong, {});
  open.press();
  rub(open, apart, strong);
  CHECK(apart.v[0] == 0.1);
  CHECK(apart.v[1] == 1.0);
}

TEST_CASE(
    "bodies meet where the plainer one's surface faces, around the node; flowing soil at corners the node's own") {
  for (const bool flows : {false, true})
    for (const double plainness : {1.0, 0.8}) {
      auto i = side(-1.0, 2.0, {1.0, 0.0}, no_soil_limit), j = side(1.0, 3.0, {0.0, 0.0}, no_soil_limit);
      i.shape.firm = true;
      j.shape.firm = !flows;
      const double size = i.shape.surface[0] < 0.0 ? -i.shape.surface[0] : i.shape.surface[0];
      i.shape.surface = {0.9 * size, 0.3 * size};  // wobbles
      i.shape.outward = {8.0 * size, 0.0};
      i.shape.faces = 8.0 * size / plainness;
      j.shape.surface = j.shape.outward = {-0.7 * size, -0.7 * size};  // a corner
      j.shape.faces = 2.0 * size;
      ContactPair<2> pair = between(i, j, {});
      pair.press();
      if (flows && plainness < 0.9)
        CHECK(i.v[1] < -0.1);
      else
        CHECK(i.v[1] == doctest::Approx(0.0));
      CHECK(i.v[0] < 1.0);
    }
}

TEST_CASE("a body whose place is not known yet touches nothing, nor keeps others apart") {
  auto i = side(-1.0, 1.0, {1.0, 0.5}, 1e4), j = side(1.0, 2.0, {0.0, 0.0}, no_soil_limit);
  const BodyShape<2> lower = i.shape, upper = j.shape;
  CHECK(lies_between(BodyShape<2>{.volume = 0.1}, lower, upper));
  CHECK_FALSE(lies_between(BodyShape<2>{}, lower, upper));
  for (const Opening opening : {Opening::free, Opening::held}) {
    i.shape = body_shape<2>(InterfaceNode{}, {});
    ContactPair<2> pair = between(i, j, {0.3, opening});
    CHECK(pair.press() == 0.0);
    CHECK_FALSE(pair.grip().any());
    CHECK(i.v == std::array<double, 2>{1.0, 0.5});
  }
}

TEST_CASE("what nodes may take off the sliding goes to those that slide, and all of it where they do") {
  constexpr int nodes = Block<2>::nodes;
  std::vector<FieldGrip<2>> grip(nodes);
  std::vector<Spread> spread(nodes);
  std::array<int, Block<2>::neighbours> around;
  around.fill(-1);
  around[Block<2>::neighbours / 2] = 0;
  const int first = 2 * Block<2>::cells + 2;  // and the next one: each in the other's reach
  for (const int n : {first, first + 1}) {
    grip[static_cast<std::size_t>(n)].mass = {n == first ? 10.0 : 0.4, 20.0};
    grip[static_cast<std::size_t>(n)].normal = {0.0, 1.0};
    grip[static_cast<std::size_t>(n)].carried = 3.0;
    grip[static_cast<std::size_t>(n)].friction = no_soil_limit;
  }
  const auto impulse_of = [&](double one, double other) {
    grip[first].sliding = one;
    grip[first + 1].sliding = other;
    for (int n = 0; n < nodes; ++n) spread[static_cast<std::size_t>(n)] = spread_of<2>(around, grip.data(), 0, n);
    return std::array<double, 2>{pooled_impulse<2>(around, grip[first], spread.data(), first),
                                 pooled_impulse<2>(around, grip[first + 1], spread.data(), first + 1)};
  };
  const auto both = impulse_of(8.0, 4.0);
  CHECK(both[0] == doctest::Approx(4.0));
  CHECK(both[1] == doctest::Approx(2.0));
  const auto one = impulse_of(0.0, 5.0);
  CHECK(one[0] == 0.0);
  CHECK(one[1] == doctest::Approx(6.0));
}

TEST_CASE("strong soil above weak soil is the upper side, that beneath it is not") {
  // Layers of one particle a row: strong, strong, weak, strong, strong; and far above strong soil again.
  Particles<2> P;
  const std::vector<double> heights = {0.35, 0.85, 1.35, 1.85, 2.35, 7.85};
  const std::vector<int> materials = {0, 0, 1, 0, 0, 0}, wanted = {0, 0, 0, 1, 1, 0};
  P.resize(heights.size() * 8, false, false);
  P.side.assign(P.count(), 0);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = 0.25 + 0.5 * static_cast<double>(p % 8);
    P.position[1][p] = heights[p / 8];
    P.volume[p] = 0.25;
    P.mass[p] = 500.0;
    P.material[p] = materials[p / 8];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  FieldChoice fields;
  fields.of_material = {0, 1};
  fields.count = 3;
  fields.by_side = true;
  BlockGrid<2> grid(h, {}, QuadraticShape::shift);
  grid.sort(P, {}, fields);
  const auto corner = [&](std::size_t b) {
    std::array<double, 2> c;
    for (int d = 0; d < 2; ++d) c[d] = (grid.occupied_index(b)[d] * Block<2>::cells + Tile<2, QuadraticShape>::low) * h;
    return c;
  };
  CHECK(find_sides<2, QuadraticShape>(grid, fields, corner, P));
  for (std::size_t p = 0; p < P.count(); ++p) CHECK(P.side[p] == wanted[static_cast<std::size_t>(P.identity[p]) / 8]);
  CHECK_FALSE(find_sides<2, QuadraticShape>(grid, fields, corner, P));
}

TEST_CASE("weak soil that slides on strong soil: momentum is exact, and bits do not depend on the threads") {
  for (const TransferName transfer :
       {TransferName::apic, TransferName::aflip, TransferName::flip, TransferName::fmpm}) {
    CAPTURE(static_cast<int>(transfer));
    std::vector<Material> materials(2);
    materials[0].name = "strong";
    materials[1].name = "weak";
    materials[1].law = &law_named("tresca");
    for (Material& m : materials) {
      m.youngs_modulus = 1e6;
      m.poisson_ratio = 0.3;
    }
    const Terrain none;
    SolverOptions o;
    o.transfer = transfer;
    o.fields.of_material = {0, 1};
    o.fields.count = 3;
    o.fields.by_side = true;
    o.fields.flows = {0, 1, 0};
    std::array<AlignedVector<double>, 2> x;
    for (int t = 0; t < 2; ++t) {
      Particles<2> P;
      P.resize(48 * 30, transfer == TransferName::apic || transfer == TransferName::aflip, false);
      P.side.assign(P.count(), 0);
      for (std::size_t p = 0; p < P.count(); ++p) {
        const std::size_t row = p / 48;
        P.position[0][p] = 0.25 * (static_cast<double>(p % 48) + 0.5);
        P.position[1][p] = 0.25 * (static_cast<double>(row) + 0.5);
        P.volume[p] = 0.0625;
        P.mass[p] = 125.0;
        P.material[p] = row >= 10 && row < 14 ? 1 : 0;
        P.strength[p] = 2e3;
        P.velocity[0][p] = row >= 14 ? 1.0 : 0.0;
        P.velocity[1][p] = row >= 14 ? -0.2 : 0.1;
        P.identity[p] = static_cast<std::int32_t>(p);
      }
      const int threads = omp_get_max_threads();
      omp_set_num_threads(t + 1);
      auto solver = make_solver<2>(o, h, {}, std::move(P), materials, none, Walls<2>{});
      solver->start(1e300);
      for (int s = 0; s < 60; ++s) solver->step({}, {}, 1e300);
      omp_set_num_threads(threads);
      const Particles<2>& Q = solver->particles();
      double px = 0.0, py = 0.0;
      for (std::size_t p = 0; p < Q.count(); ++p) {
        px += Q.mass[p] * Q.velocity[0][p];
        py += Q.mass[p] * Q.velocity[1][p];
      }
      CHECK(px == doctest::Approx(16 * 48 * 125.0).epsilon(1e-12));
      CHECK(py == doctest::Approx((14 * 0.1 - 16 * 0.2) * 48 * 125.0).epsilon(1e-11));
      CHECK(solver->work().contact > 0.0);
      x[static_cast<std::size_t>(t)] = Q.position[0];
    }
    CHECK(x[0] == x[1]);
  }
}

TEST_CASE("soils in strips that slide together are braked by the ground with its friction on all of their weight") {
  constexpr double friction = 0.3, gravity = 9.81, density = 2000.0, spacing = 0.25, speed = 3.0;
  constexpr std::size_t columns = 64, rows = 8;
  std::vector<Material> materials(2);
  materials[0].name = "strong";
  materials[0].law = &law_named("linear_elastic");
  materials[1].name = "weak";
  materials[1].law = &law_named("tresca");
  for (Material& m : materials) {
    m.youngs_modulus = 1e7;
    m.poisson_ratio = 0.3;
  }
  Particles<2> P;
  P.resize(columns * rows, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const std::size_t column = p % columns;
    P.position[0][p] = spacing * (static_cast<double>(column) + 0.5);
    P.position[1][p] = spacing * (static_cast<double>(p / columns) + 0.5);
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.material[p] = column / 4 % 2 == 0 ? 0 : 1;  // strips of 1 m, two cells: nearly all nodes are shared
    P.strength[p] = 1e6;
    P.velocity[0][p] = speed;
    P.identity[p] = static_cast<std::int32_t>(p);
    P.stress[1][p] = -density * gravity * (spacing * static_cast<double>(rows) - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = 0.43 * P.stress[1][p];
  }
  SolverOptions o;
  o.fields.of_material = {0, 1};
  o.fields.count = 2;
  o.fields.flows = {0, 1};
  o.soil_limits_friction = false;
  Terrain ground;
  ground.add_line({{{-100.0, 0.0}}, {{100.0, 0.0}}}, {friction}, false);
  const auto solver = make_solver<2>(o, h, {}, std::move(P), materials, ground, Walls<2>{});
  solver->start(1e300);
  double time = 0.0;
  while (time < 0.5) time += solver->step({0.0, -gravity}, {}, 1e300).dt;
  const Particles<2>& Q = solver->particles();
  double momentum = 0.0, mass = 0.0;
  for (std::size_t p = 0; p < Q.count(); ++p) {
    momentum += Q.mass[p] * Q.velocity[0][p];
    mass += Q.mass[p];
  }
  CHECK(momentum / mass == doctest::Approx(speed - friction * gravity * time).epsilon(0.02));
}

namespace {

// m/s after 2 s of a slab of phi = 0 soil, 12 x 2 m, that slides at 4 m/s down a plane at 8 degrees to the grid;
// gravity along it is what the slab's strength takes. The plane is the ground's, or cut from firm particles in rows
// along the grid: stairs.
double speed_of_slab(bool on_particles) {
  constexpr double angle = 8.0 * 3.14159265358979 / 180.0, spacing = 0.25, density = 2000.0, height = 2.0;
  constexpr double strength = 6e3, along_plane = strength / (density * height), across = 5.0, speed = 4.0;
  const double c = std::cos(angle), s = std::sin(angle), depth = on_particles ? 2.0 : 0.0;
  std::vector<Material> materials(2);
  materials[0].name = "firm";
  materials[0].law = &law_named("linear_elastic");
  materials[0].youngs_modulus = 1e8;
  materials[1].name = "weak";
  materials[1].law = &law_named("tresca");
  materials[1].youngs_modulus = 1e7;
  for (Material& m : materials) m.poisson_ratio = 0.3;
  std::vector<std::array<double, 2>> places;  // m, along the plane and above it
  for (int k = 0; k < 160 * 60; ++k) {
    const double x = spacing * (k % 160 + 0.5), y = spacing * (k / 160 - 15.5);
    const double along = x * c + y * s, above = y * c - x * s;
    if (above > 0.0 ? above < height && along > 6.0 && along < 18.0 : above > -depth && along > 2.0 && along < 36.0)
      places.push_back({along, above});
  }
  Particles<2> P;
  P.resize(places.size(), true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const auto [along, above] = places[p];
    const bool weak = above > 0.0;
    P.position[0][p] = along * c - above * s;
    P.position[1][p] = along * s + above * c;
    P.volume[p] = spacing * spacing;
    P.mass[p] = density * P.volume[p];
    P.material[p] = weak ? 1 : 0;
    P.strength[p] = strength;
    P.velocity[0][p] = weak ? speed * c : 0.0;
    P.velocity[1][p] = weak ? speed * s : 0.0;
    P.identity[p] = static_cast<std::int32_t>(p);
    for (int d = 0; d < 3; ++d) P.stress[d][p] = weak ? -density * across * (height - above) : 0.0;
  }
  SolverOptions o;
  o.fields.of_material = {0, 1};
  o.fields.count = 2;
  o.fields.flows = {0, 1};
  Terrain ground;
  ground.add_line(
      {{{-100.0 * c + depth * s, -100.0 * s - depth * c}}, {{100.0 * c + depth * s, 100.0 * s - depth * c}}}, {5.0},
      on_particles);
  const auto solver = make_solver<2>(o, h, {0.0, -20.0}, std::move(P), materials, ground, Walls<2>{});
  solver->start(1e300);
  double time = 0.0, momentum = 0.0, mass = 0.0;
  while (time < 2.0) time += solver->step({along_plane * c + across * s, along_plane * s - across * c}, {}, 1e300).dt;
  const Particles<2>& Q = solver->particles();
  for (std::size_t p = 0; p < Q.count(); ++p) {
    if (Q.material[p] == 0) continue;
    momentum += Q.mass[p] * (Q.velocity[0][p] * c + Q.velocity[1][p] * s);
    mass += Q.mass[p];
  }
  return momentum / mass;
}

}  // namespace

TEST_CASE("soil slides on stairs of firm particles as on the plane that they stand for") {
  const double on_ground = speed_of_slab(false), on_particles = speed_of_slab(true);
  CAPTURE(on_ground);
  CHECK(on_particles == doctest::Approx(on_ground).epsilon(0.05));
}

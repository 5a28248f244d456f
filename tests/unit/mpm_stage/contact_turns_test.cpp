#include "mpm_stage/boundary/contact_turns.hpp"

#include <doctest/doctest.h>

#include <random>

#include "mpm_stage/grid/shape_functions.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.5, dt = 1e-3, friction = 0.4;
const HalfSpaces<QuadraticShape> half;

// What moves, and where its centre is for contact.
struct Body : BodyAtNode<2> {
  BodyShape<2> shape;
};

Body body_at(double x, double y, double mass, std::array<double, 2> v) {
  Body body;
  body.mass = mass;
  body.v = body.before = v;
  body.shape.volume = 0.5 * h * h;
  body.shape.centre = {x * h, y * h};
  body.shape.strength = 1e4;
  return body;
}

template <std::size_t N>
struct Bodies {
  std::array<BodyAtNode<2>, N> body;
  std::array<BodyShape<2>, N> shape;
  ContactPairs<2> pairs;

  explicit Bodies(const std::array<Body, N>& bodies) {
    for (std::size_t b = 0; b < N; ++b) {
      body[b] = bodies[b];
      shape[b] = bodies[b].shape;
    }
  }
  void meet(std::size_t i, std::size_t j) {
    pairs.add(ContactPair<2>(body[i], body[j], ContactSurface<2>(shape[i], shape[j], h, half), {}, dt),
              static_cast<int>(i), static_cast<int>(j));
  }
};

NodeContact level_ground() {
  NodeContact contact;
  contact.count = 1;
  contact.point[0].normal = {0.0, 1.0};
  contact.point[0].friction = friction;
  return contact;
}

// Both bodies on the ground, with nothing but the push that the ground has given each.
std::array<GroundPush<2>, 2> settle_two(const NodeContact& ground, Body& a, Body& b) {
  Bodies<2> node({a, b});
  node.meet(0, 1);
  std::array<GroundPush<2>, 2> push{GroundPush<2>(ground, a.mass, 0.0), GroundPush<2>(ground, b.mass, 0.0)};
  settle(node.pairs, node.body.data(), push.data(), 2);
  a.v = node.body[0].v;
  b.v = node.body[1].v;
  return push;
}

double energy(const BodyAtNode<2>& b) {
  return 0.5 * b.mass * (b.v[0] * b.v[0] + b.v[1] * b.v[1]);
}

}  // namespace

TEST_CASE("bodies side by side that are pressed into the ground do not push each other aside, however they face") {
  const NodeContact ground = level_ground();
  for (const double rise : {-0.3, 0.0, 0.3}) {
    auto firm = body_at(-0.3, 0.0, 2.0, {0.0, -1.0}), weak = body_at(0.3, rise, 0.1, {0.0, -8.0});
    const auto push = settle_two(ground, firm, weak);
    CHECK(firm.v == std::array<double, 2>{0.0, 0.0});
    CHECK(weak.v == std::array<double, 2>{0.0, 0.0});
    CHECK(push[0].grip().friction == doctest::Approx(friction * 2.0 * 1.0));
    CHECK(push[1].grip().friction == doctest::Approx(friction * 0.1 * 8.0));
  }
}

TEST_CASE("a body on top of another passes its push on to the ground") {
  const NodeContact ground = level_ground();
  auto below = body_at(0.0, -0.3, 1.0, {0.0, 0.0}), above = body_at(0.0, 0.3, 2.0, {0.5, -1.0});
  // The ground does not reach the upper one, which the node's gap does not tell.
  Bodies<2> node({below, above});
  node.meet(0, 1);
  std::array<GroundPush<2>, 2> push{GroundPush<2>(ground, 1.0, 0.0), GroundPush<2>(ground, 2.0, 1e9)};
  settle(node.pairs, node.body.data(), push.data(), 2);
  CHECK(node.body[0].v[1] == doctest::Approx(0.0).scale(1.0));
  CHECK(node.body[1].v[1] == doctest::Approx(0.0).scale(1.0).epsilon(1e-4));
  CHECK(node.body[1].v[0] == 0.5);
  CHECK(push[0].grip().friction == doctest::Approx(friction * 2.0).epsilon(1e-4));
  CHECK(!push[1].grip().pushed);
}

TEST_CASE("a body that another one lifts off the ground has got nothing from the ground") {
  const NodeContact ground = level_ground();
  Bodies<2> node({body_at(0.0, -0.3, 1.0, {0.0, 2.0}), body_at(0.0, 0.3, 1.0, {0.0, -1.0})});
  node.meet(0, 1);
  std::array<GroundPush<2>, 2> push{GroundPush<2>(ground, 1.0, 0.0), GroundPush<2>(ground, 1.0, 0.0)};
  settle(node.pairs, node.body.data(), push.data(), 2);
  for (const BodyAtNode<2>& b : node.body) CHECK(b.v[1] == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(!push[0].grip().pushed);
  CHECK(push[1].impulse()[1] == doctest::Approx(0.0).scale(1.0).epsilon(1e-4));
}

TEST_CASE("ground that soil adheres to holds a body, and what another one presses on it") {
  NodeContact ground = level_ground();
  ground.adhere = true;
  auto held = body_at(-0.3, 0.0, 1.0, {2.0, 1.0}), other = body_at(0.3, 0.0, 1.0, {-3.0, 0.5});
  Bodies<2> node({held, other});
  node.meet(0, 1);
  std::array<GroundPush<2>, 2> push{GroundPush<2>(ground, 1.0, 0.0), GroundPush<2>(ground, 1.0, 1e9)};
  settle(node.pairs, node.body.data(), push.data(), 2);
  CHECK(node.body[0].v == std::array<double, 2>{0.0, 0.0});
  CHECK(node.body[1].v[0] == doctest::Approx(0.0).scale(1.0).epsilon(1e-5));
  CHECK(node.body[1].v[1] == 0.5);
  CHECK(push[0].impulse()[0] == doctest::Approx(-2.0 + 3.0));
}

TEST_CASE("soils mixed through each other move as one, and not into the ground although one is still above it") {
  const NodeContact ground = level_ground();
  Bodies<2> node({body_at(0.0, 0.0, 1.0, {1.0, -1.0}), body_at(0.001, 0.0, 3.0, {0.0, -2.0})});
  node.meet(0, 1);
  std::array<GroundPush<2>, 2> push{GroundPush<2>(ground, 1.0, 0.0), GroundPush<2>(ground, 3.0, 1e9)};
  settle(node.pairs, node.body.data(), push.data(), 2);
  CHECK(node.body[0].v[0] == doctest::Approx(0.25));
  CHECK(node.body[1].v[0] == doctest::Approx(0.25));
  CHECK(std::fabs(node.body[0].v[1]) < 1e-12);
  CHECK(node.body[1].v[1] == doctest::Approx(0.0).scale(1.0).epsilon(0.001));
}

TEST_CASE("a thin layer between two bodies passes a push on, down to the ground") {
  const NodeContact ground = level_ground();
  Bodies<3> node(
      {body_at(0.0, -0.6, 2.0, {0.0, 0.0}), body_at(0.0, 0.0, 0.5, {0.0, 0.0}), body_at(0.0, 0.6, 2.0, {0.0, -1.0})});
  node.meet(0, 1);
  node.meet(1, 2);
  std::array<GroundPush<2>, 3> push{GroundPush<2>(ground, 2.0, 0.0), GroundPush<2>(ground, 0.5, 1e9),
                                    GroundPush<2>(ground, 2.0, 1e9)};
  settle(node.pairs, node.body.data(), push.data(), 3);
  for (const BodyAtNode<2>& b : node.body) CHECK(std::fabs(b.v[1]) < 0.02);
  CHECK(push[0].impulse()[1] == doctest::Approx(2.0).epsilon(0.03));
}

TEST_CASE("whatever meets on the ground: no energy is made, nothing goes into it, momentum comes from it alone") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> some(-1.0, 1.0), mass(0.1, 10.0);
  for (int k = 0; k < 1000; ++k) {
    NodeContact ground = level_ground();
    if (k % 3 == 0) {  // a valley's corner
      ground.count = 2;
      ground.point[1].normal = {0.6, 0.8};
    }
    auto a = body_at(-0.3 + 0.1 * some(random), 0.3 * some(random), mass(random), {some(random), some(random)});
    auto b = body_at(0.3, 0.3 * some(random), mass(random), {some(random), some(random)});
    const double start = energy(a) + energy(b);
    std::array<double, 2> momentum;
    for (int d = 0; d < 2; ++d) momentum[d] = a.mass * a.v[d] + b.mass * b.v[d];
    const auto push = settle_two(ground, a, b);
    CHECK(energy(a) + energy(b) <= start * (1.0 + 1e-14));
    for (int d = 0; d < 2; ++d)
      CHECK(a.mass * a.v[d] + b.mass * b.v[d] - push[0].impulse()[d] - push[1].impulse()[d] ==
            doctest::Approx(momentum[d]).epsilon(1e-12));
    for (int p = 0; p < ground.count; ++p)
      for (const Body& body : {a, b})
        CHECK(body.v[0] * ground.point[p].normal[0] + body.v[1] * ground.point[p].normal[1] > -0.02);
  }
}

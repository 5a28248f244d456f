// Terrain lines that cross, touch or turn back on themselves are found, with the place; rings and folds that keep clear
// are left alone.
#include "mpm_stage/scene/line_crossing.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>

using tailrun::mpm::first_crossing;
using Points = std::vector<std::array<double, 2>>;

namespace {

void check_at(const Points& points, std::size_t first, std::size_t second, double x, double y) {
  const auto found = first_crossing(points);
  REQUIRE(found);
  CHECK(found->first == first);
  CHECK(found->second == second);
  CHECK(found->place[0] == doctest::Approx(x));
  CHECK(found->place[1] == doctest::Approx(y));
}

}  // namespace

TEST_CASE("what crosses or touches itself is found, whichever way it is drawn") {
  const Points loop = {{0, 0}, {10, 0}, {10, 5}, {4, -5}};
  check_at(loop, 0, 2, 7, 0);
  check_at({loop.rbegin(), loop.rend()}, 0, 2, 7, 0);
  check_at({{0, 0}, {10, 0}, {10, 5}, {4, 0}}, 0, 2, 4, 0);                // ends on the line
  check_at({{0, 0}, {4, 0}, {10, 0}, {10, 5}, {4, 0}}, 0, 3, 4, 0);        // ends on a point of it
  check_at({{0, 0}, {10, 0}, {5, 0}}, 0, 1, 10, 0);                        // turns back
  check_at({{0, 0}, {0, 9}, {1, 9}, {1, 4}, {-1, 4}}, 0, 3, 0, 4);         // along y
  check_at({{0, 0}, {8, 0}, {8, 3}, {9, 3}, {9, 0}, {5, 0}}, 0, 4, 5, 0);  // lies on itself
}

TEST_CASE("ground, channels, overhangs, rings and folds close by are no crossings") {
  CHECK_FALSE(first_crossing({{0, 0}, {10, 0}}));
  CHECK_FALSE(first_crossing({{0, 0}, {5, 2}, {10, 0}, {20, -3}}));
  CHECK_FALSE(first_crossing({{0, 8}, {0, 0}, {10, 0}, {10, 8}}));
  CHECK_FALSE(first_crossing({{0, 0}, {5, 0}, {4, 3}, {9, 3}}));
  CHECK_FALSE(first_crossing({{0, 0}, {10, 0}, {10, 5}, {0, 5}, {0, 0}}));
  CHECK_FALSE(first_crossing({{0, 0}, {10, 0}, {10, 1e-9}, {0, 1e-9}}));
  CHECK_FALSE(first_crossing({{0, 0}, {4, 0}, {10, 0}}));  // straight on
}

TEST_CASE("a ring that crosses itself where it closes is found") {
  CHECK(first_crossing({{0, 0}, {10, 0}, {10, 5}, {5, 0}, {0, 0}}));
  CHECK(first_crossing({{0, 0}, {10, 0}, {10, 5}, {15, 0}, {0, 0}}));
  CHECK_FALSE(first_crossing({{0, 0}, {10, 0}, {10, 5}, {-5, 0}, {0, 0}}));
}

TEST_CASE("a line of 200 000 points that goes to and fro takes no time to speak of") {
  Points points;
  for (int i = 0; i < 200000; ++i)
    points.push_back({0.01 * i + (i % 3 == 0 ? -0.015 : 0.0), std::sin(0.001 * i) + 0.001 * (i % 3)});
  const auto start = std::chrono::steady_clock::now();
  first_crossing(points);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 5.0);
}

#include "mpm_stage/transfer/patch_filling.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.5, density = 1900.0;
using Point = std::array<double, 2>;

// Four particles in each of 24 x 24 cells from the origin on, each where `moved` puts it.
Particles<2> square(const std::function<Point(Point)>& moved) {
  Particles<2> P;
  P.resize(48 * 48, true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const Point x =
        moved({0.5 * h * (static_cast<double>(p % 48) + 0.5), 0.5 * h * (static_cast<double>(p / 48) + 0.5)});
    for (int d = 0; d < 2; ++d) P.position[d][p] = x[d];
    P.volume[p] = 0.25 * h * h;
    P.mass[p] = density * P.volume[p];
  }
  return P;
}

// What is found in the patch around a point.
struct Found {
  Found(Particles<2> particles, double relief) : P(std::move(particles)), filling(relief) {
    grid.sort(P);
    filling.lay_out(grid, [](std::size_t, int) { return 1.0; });
    std::vector<PatchSum> sums(grid.active() * Block<2>::nodes, PatchSum{});
    std::vector<Vec4> masses(sums.size(), Vec4{});
    const auto place = [this](int i, int j) -> std::ptrdiff_t {
      for (std::size_t a = 0; a < grid.active(); ++a) {
        const int x = i - grid.active_index(a)[0] * 8, y = j - grid.active_index(a)[1] * 8;
        if (x >= 0 && x < 8 && y >= 0 && y < 8) return static_cast<std::ptrdiff_t>(a) * Block<2>::nodes + y * 8 + x;
      }
      return -1;
    };
    for (std::size_t p = 0; p < P.count(); ++p) {
      double w[2][3], unused[3], moment[3];
      int first[2], patch[2];
      for (int d = 0; d < 2; ++d) {
        const double X = P.position[d][p] / h + 64.0;
        first[d] = QuadraticShape::evaluate(X, w[d], unused, moment) - 64;
        patch[d] = 2 * static_cast<int>(X / 2.0) - 64;
      }
      for (int n = 0; n < 9; ++n) {
        const auto node = place(first[0] + n % 3, first[1] + n / 3);
        if (node >= 0) masses[static_cast<std::size_t>(node)][0] += w[0][n % 3] * w[1][n / 3] * P.mass[p];
      }
      const auto sum = static_cast<std::size_t>(place(patch[0], patch[1]));
      sums[sum + 1][3] += P.volume[p];
      sums[sum + 8][3] += P.mass[p];
    }
    fits.assign(sums.size(), PatchFit{});
    for (std::size_t a = 0; a < grid.active(); ++a) {
      filling.begin(a, false);
      filling.weigh(a, masses.data() + a * Block<2>::nodes);
      filling.compare(a, sums.data() + a * Block<2>::nodes);
    }
    for (std::size_t a = 0; a < grid.active(); ++a) filling.judge(a, fits.data() + a * Block<2>::nodes);
    at = [this, place](double x, double y) {
      return fits[static_cast<std::size_t>(place(2 * static_cast<int>(x / h / 2), 2 * static_cast<int>(y / h / 2))) +
                  1];
    };
  }

  Particles<2> P;
  BlockGrid<2> grid{h, {0.0, 0.0}, QuadraticShape::shift};
  PatchFilling<2> filling;
  std::vector<PatchFit> fits;
  std::function<PatchFit(double, double)> at;
};

TEST_CASE("particles that stand as close as their volumes are not crowded, at the surface neither") {
  Found found(square([](Point x) { return x; }), 1.0);
  for (const double x : {0.5, 1.5, 5.5, 11.5})
    for (const double y : {0.5, 6.5, 11.5}) CHECK(found.at(x, y)[1] == doctest::Approx(0.0));
}

TEST_CASE("particles closer than their volumes are crowded by as much") {
  Found found(square([](Point x) { return Point{x[0] / 1.1, x[1]}; }), 1.0);
  CHECK(found.at(5.5, 6.5)[1] == doctest::Approx(0.1).epsilon(0.1));
}

TEST_CASE("particles farther apart than their volumes count where all around is full, and not at the surface") {
  Found found(square([](Point x) { return Point{1.05 * x[0], x[1]}; }), 1.0);
  CHECK(found.at(5.5, 6.5)[1] == doctest::Approx(-1.0 + 1.0 / 1.05).epsilon(0.2));
  CHECK(found.at(5.5, 11.5)[1] == 0.0);
}

}  // namespace

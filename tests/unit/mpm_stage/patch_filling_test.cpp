#include "mpm_stage/transfer/patch_filling.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/material/stress_update.hpp"

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
  // `soils` that share each node's mass equally.
  explicit Found(Particles<2> particles, int soils = 1) : P(std::move(particles)) {
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
        if (node >= 0) masses[static_cast<std::size_t>(node)][0] += w[0][n % 3] * w[1][n / 3] * P.mass[p] / soils;
      }
      const auto sum = static_cast<std::size_t>(place(patch[0], patch[1]));
      sums[sum + 1][3] += P.volume[p];
      sums[sum + 8][3] += P.mass[p];
    }
    fits.assign(sums.size(), PatchFit{});
    for (std::size_t a = 0; a < grid.active(); ++a) {
      filling.begin(a, false);
      for (int k = 0; k < soils; ++k) filling.weigh(a, masses.data() + a * Block<2>::nodes);
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
  PatchFilling<2> filling{1.0};
  std::vector<PatchFit> fits;
  std::function<PatchFit(double, double)> at;
};

Material clay() {
  Material soil;
  soil.law = &law_named("tresca");
  soil.youngs_modulus = 5e6;
  soil.poisson_ratio = 0.33;
  return soil;
}

TEST_CASE("particles that stand as close as their volumes are not crowded, at the surface neither") {
  Found found(square([](Point x) { return x; }));
  for (const double x : {0.5, 1.5, 5.5, 11.5})
    for (const double y : {0.5, 6.5, 11.5}) CHECK(found.at(x, y)[1] == doctest::Approx(0.0));
}

TEST_CASE("particles closer than their volumes are crowded by as much") {
  Found found(square([](Point x) { return Point{x[0] / 1.1, x[1]}; }));
  CHECK(found.at(5.5, 6.5)[1] == doctest::Approx(0.1).epsilon(0.1));
}

TEST_CASE("where soils meet, what is crowded by less than a tenth is left alone") {
  const auto crowded = [](double share) {
    return square([share](Point x) { return Point{x[0] / (1.0 + share), x[1]}; });
  };
  CHECK(Found(crowded(0.08)).at(5.5, 6.5)[1] == doctest::Approx(0.08).epsilon(0.1));
  CHECK(Found(crowded(0.08), 2).at(5.5, 6.5)[1] == 0.0);
  CHECK(Found(crowded(0.25), 2).at(5.5, 6.5)[1] == doctest::Approx(0.15).epsilon(0.05));
}

TEST_CASE("particles farther apart than their volumes count where all around is full, and not at the surface") {
  Found found(square([](Point x) { return Point{1.05 * x[0], x[1]}; }));
  CHECK(found.at(5.5, 6.5)[1] == doctest::Approx(-1.0 + 1.0 / 1.05).epsilon(0.2));
  CHECK(found.at(5.5, 11.5)[1] == 0.0);
}

TEST_CASE("crowded particles give up volume with their shear, and are given the energy that it takes") {
  constexpr int T = Tile<2, QuadraticShape>::side;
  constexpr double crowding = 0.1, relief = 0.5;
  const MaterialConstants k = constants_of(clay(), h);
  const double K = VolumetricLaw<2>(k).modulus;
  auto P = square([](Point x) { return x; });
  AlignedVector<PatchFit> fit(Tile<2, QuadraticShape>::nodes, PatchFit{});
  for (int j = 0; j + 1 < T; j += 2)
    for (int i = 0; i + 1 < T; i += 2) fit[static_cast<std::size_t>(j * T + i + 1)] = PatchFit{0.0, crowding, 0.0, 0.0};
  const std::size_t n = 8;  // of the first row, in the tile that begins at the origin
  double wanted = 0.0, increment[n];
  for (std::size_t p = 0; p < n; ++p) {
    P.stress[0][p] = P.stress[1][p] = -0.002 * K * static_cast<double>(p + 1);
    P.gradient[1][p] = 0.02;   // shear
    P.gradient[0][p] = 0.001;  // and stretch along x: shear too, and volume
  }
  const double given =
      gather_volumetric<2, QuadraticShape>(k, P, 0, n, {0.0, 0.0}, 1.0 / h, fit.data(), relief, increment);
  const double off = relief * crowding * std::sqrt(0.02 * 0.02 + 0.001 * 0.001);
  for (std::size_t p = 0; p < n; ++p) {
    CHECK(increment[p] == doctest::Approx(0.001 - off));
    const double before = P.stress[0][p] + K * 0.001, after = P.stress[0][p] + K * increment[p];
    wanted += P.volume[p] * (after * after - before * before) / (2.0 * K);
  }
  CHECK(given == doctest::Approx(wanted));
}

TEST_CASE("soil that is pulled gives up nothing, and soil with room around is pulled by none of it") {
  constexpr int T = Tile<2, QuadraticShape>::side;
  const MaterialConstants k = constants_of(clay(), h);
  const double K = VolumetricLaw<2>(k).modulus;
  const auto relieved = [&](double stress, double crowding) {
    AlignedVector<PatchFit> fit(Tile<2, QuadraticShape>::nodes, PatchFit{});
    for (int j = 0; j + 1 < T; j += 2)
      for (int i = 0; i + 1 < T; i += 2)
        fit[static_cast<std::size_t>(j * T + i + 1)] = PatchFit{0.0, crowding, 0.0, 0.0};
    auto P = square([](Point x) { return x; });
    P.stress[0][0] = P.stress[1][0] = stress;
    P.gradient[1][0] = 0.02;
    double increment[1];
    gather_volumetric<2, QuadraticShape>(k, P, 0, 1, {0.0, 0.0}, 1.0 / h, fit.data(), 1.0, increment);
    return increment[0];
  };
  CHECK(relieved(1e3, 0.2) == 0.0);
  CHECK(relieved(-1e3, 0.2) == doctest::Approx(-0.2 * 0.02));
  CHECK(relieved(-1e-4 * K, -0.2) == doctest::Approx(1e-4));
}

TEST_CASE("what a crowded fluid is given is what its pressure stores, and a drop without pressure stores nothing") {
  constexpr int T = Tile<2, QuadraticShape>::side;
  Material water;
  water.law = &law_named("newtonian_fluid");
  water.bulk_modulus = 2e6;
  water.density = density;
  const MaterialConstants k = constants_of(water, h);
  AlignedVector<PatchFit> fit(Tile<2, QuadraticShape>::nodes, PatchFit{});
  for (int j = 0; j + 1 < T; j += 2)
    for (int i = 0; i + 1 < T; i += 2) fit[static_cast<std::size_t>(j * T + i + 1)] = PatchFit{0.0, 0.2, 0.0, 0.0};
  const auto given = [&](double size) {
    auto P = square([](Point x) { return x; });
    double trace[1], unrelieved[1];
    P.volume[0] *= size;
    P.gradient[1][0] = 0.02;
    for (int i = 0; i < 3; ++i) P.stress[i][0] = size < 1.0 ? -water.bulk_modulus * (1.0 / size - 1.0) : 0.0;
    const double got = gather_volumetric<2, QuadraticShape>(k, P, 0, 1, {0.0, 0.0}, 1.0 / h, fit.data(), 1.0, trace);
    gather_volumetric<2, QuadraticShape>(k, P, 0, 1, {0.0, 0.0}, 1.0 / h, fit.data(), 0.0, unrelieved);
    const auto stored = [&](double increment) {
      auto after = P;
      update_stress(k, after, 0, 1, &increment, 1e-3);
      return elastic_energy(k, after, 0, 1);
    };
    CHECK(got == doctest::Approx(stored(trace[0]) - stored(unrelieved[0])).epsilon(1e-9));
    return got;
  };
  CHECK(given(1.2) == 0.0);
  CHECK(given(0.98) > 0.0);
}

}  // namespace

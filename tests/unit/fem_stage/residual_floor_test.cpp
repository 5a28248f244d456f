// Liquefied soil with its residual strength as a floor: one PM4Sand point, one element at large displacement.
#include "fem_stage/material/residual_floor.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fem_stage/material/material_points.hpp"
#include "material_drive.hpp"

using namespace tailrun::fem;

namespace {

constexpr double s_R = 9.1e3;  // Pa, at 186 kPa in the main case
constexpr double sigma_v0 = 186e3;
using Plane = std::array<double, 4>;

double radius(const Plane& s) {
  return std::hypot(0.5 * (s[0] - s[1]), s[3]);
}

// The main case's tailings at constant volume, with and without a floor.
struct Sheared {
  MaterialPoints points{{{"tailings", testing::tailings()}}, {0}};
  ResidualFloor floor{{s_R}, std::array{0.05}};
  Plane stress{-0.5 * sigma_v0, -sigma_v0, -0.5 * sigma_v0, 0.0};
  bool has_floor;

  explicit Sheared(bool with_floor) : has_floor(with_floor) {
    points.set_stress(stress);
    points.start_plastic_stage(true);
  }
  // Engineering shear strain `amount` in steps, gamma_xy turned by half of `direction` (rad). Returns the least and the
  // largest stress (Pa) after the first `wait` of strain.
  std::array<double, 2> shear(double amount, double direction, double wait, double step = 2e-4) {
    std::array<double, 2> range{1e300, 0.0};
    const std::array<double, 3> e{0.5 * step * std::sin(direction), -0.5 * step * std::sin(direction),
                                  step * std::cos(direction)};
    for (double done = 0.0; done < amount - 0.5 * step; done += step) {
      points.update(e, stress);
      if (has_floor) floor.update(e, stress);
      points.commit();
      floor.commit();
      if (done >= wait) range = {std::min(range[0], radius(stress)), std::max(range[1], radius(stress))};
    }
    return range;
  }
};

}  // namespace

TEST_CASE("residual floor: liquefied PM4Sand carries s_R from 50 to 300 %, in any direction and when turned") {
  for (const double direction : {0.0, 0.5 * std::numbers::pi, 2.2, std::numbers::pi}) {
    Sheared soil(true), bare(false);
    for (Sheared* each : {&soil, &bare}) each->shear(0.05, 0.0, 0.0);  // liquefies
    CHECK(soil.stress == bare.stress);                                 // not active: the same bits
    CHECK(1.0 + soil.stress[1] / sigma_v0 > 0.7);
    const Plane before = soil.stress;
    soil.floor.activate(0);
    const std::array<double, 3> none{};
    soil.points.update(none, soil.stress);
    soil.floor.update(none, soil.stress);
    CHECK(soil.stress == before);  // nothing jumps
    const auto there = soil.shear(3.0, direction, 0.5);
    CHECK(there[0] > 0.98 * s_R);
    CHECK(there[1] < 1.0000001 * s_R);
    const auto back = soil.shear(1.0, direction + std::numbers::pi, 0.5);
    CHECK(back[0] > 0.98 * s_R);
    CHECK(back[1] < 1.0000001 * s_R);
    CHECK(bare.shear(3.0, direction, 0.5)[1] < 0.5 * s_R);  // PM4Sand's own plateau
  }
}

TEST_CASE("residual floor: mean stress is the model's own, and so is a strength above s_R") {
  Sheared soil(true), bare(false);
  soil.floor.activate(0);
  for (int k = 0; k < 40; ++k) {  // peak of 49 kPa at 0.75 %
    soil.shear(1e-3, 0.0, 0.0);
    bare.shear(1e-3, 0.0, 0.0);
    CHECK(soil.stress[0] + soil.stress[1] == doctest::Approx(bare.stress[0] + bare.stress[1]).epsilon(1e-12));
    if (radius(bare.stress) > s_R) CHECK(radius(soil.stress) == doctest::Approx(radius(bare.stress)).epsilon(1e-12));
  }
}

TEST_CASE("residual floor: takes energy and never gives any, whatever the path and the model do") {
  ResidualFloor floor({s_R}, std::array{0.05});
  floor.activate(0);
  const double G = floor.shear(0);
  CHECK(G == doctest::Approx(s_R / 0.05));
  unsigned seed = 1;
  const auto random = [&seed] {  // [-1, 1)
    seed = 1664525u * seed + 1013904223u;
    return static_cast<double>(seed >> 8) / 8388608.0 - 1.0;
  };
  double dissipated = 0.0, least = 0.0;
  std::array<double, 2> before{};
  for (int k = 0; k < 20000; ++k) {
    const std::array<double, 3> e{0.02 * random(), 0.02 * random(), 0.04 * random()};
    const double d = 1.5 * s_R * random(), xy = 1.5 * s_R * random();  // what the model might carry
    const Plane model{-d, d, 0.0, xy};
    Plane total = model;
    floor.update(e, total);
    CHECK(radius(total) <= std::max(s_R, radius(model)) * (1.0 + 1e-12));
    floor.commit();
    const auto b = floor.stress();
    const double work = b[0] * (e[0] - e[1]) + b[1] * e[2],
                 stored = (b[0] * b[0] + b[1] * b[1] - before[0] * before[0] - before[1] * before[1]) / (2.0 * G);
    least = std::min(least, work - stored);
    dissipated += work - stored;
    before = {b[0], b[1]};
  }
  CHECK(least >= -1e-9 * s_R);
  CHECK(dissipated > 0.0);
}

TEST_CASE("residual floor: a point without strength has none, and another run goes on with the same bits") {
  const std::array<double, 3> mobilisation{0.05, 0.05, 0.05};
  ResidualFloor floor({0.0, s_R, s_R}, mobilisation), other({0.0, s_R, s_R}, mobilisation);
  floor.activate(0);
  floor.activate(1);
  CHECK_FALSE(floor.is_active(0));
  CHECK_FALSE(floor.is_active(2));
  const std::array<double, 9> e{1e-3, 0.0, 0.01, 1e-3, 0.0, 0.01, 1e-3, 0.0, 0.01};
  std::array<double, 12> stress{}, resumed{};
  floor.update(e, stress);
  CHECK(stress[3] == 0.0);
  CHECK(stress[7] == doctest::Approx(0.01 * s_R / 0.05));
  CHECK(stress[11] == 0.0);
  floor.commit();
  other.restore(floor.stress(), floor.active());
  stress.fill(0.0);
  floor.update(e, stress);
  other.update(e, resumed);
  CHECK(resumed == stress);
  CHECK(other.shear(1) == floor.shear(1));
}

TEST_CASE("residual floor: any number of threads gives the same bits") {
  constexpr std::size_t n = 1000;
  std::vector<double> result[2];
  const int before = omp_get_max_threads();
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    ResidualFloor floor(std::vector<double>(n, s_R), std::vector<double>(n, 0.05));
    std::vector<double> e(3 * n), stress(4 * n);
    for (std::size_t i = 0; i < n; ++i) floor.activate(i);
    for (std::size_t i = 0; i < 3 * n; ++i) e[i] = 0.05 * std::sin(static_cast<double>(i));
    for (std::size_t i = 0; i < 4 * n; ++i) stress[i] = 5e3 * std::cos(static_cast<double>(i));
    floor.update(e, stress);
    result[threads / 3] = stress;
  }
  omp_set_num_threads(before);
  CHECK(result[0] == result[1]);
}

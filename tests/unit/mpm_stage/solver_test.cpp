#include "mpm_stage/step/solver.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>
#include <random>

using namespace tailrun::mpm;

namespace {

Material soil(const char* law) {
  Material m;
  m.name = "soil";
  m.law = &law_named(law);
  m.youngs_modulus = 1e6;
  m.poisson_ratio = 0.3;
  m.friction_angle = 30.0;
  return m;
}

template <int Dim>
Particles<Dim> block(double spacing, std::array<int, 3> count, bool affine) {
  Particles<Dim> P;
  const auto n = static_cast<std::size_t>(count[0] * count[1] * (Dim == 3 ? count[2] : 1));
  P.resize(n, affine, false);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  for (std::size_t p = 0; p < n; ++p) {
    std::size_t rest = p;
    for (int d = 0; d < Dim; ++d) {
      P.position[d][p] = (static_cast<double>(rest % count[d]) + 0.5 + jitter(random)) * spacing;
      P.velocity[d][p] = jitter(random);
      rest /= static_cast<std::size_t>(count[d]);
    }
    P.mass[p] = 2000.0 * std::pow(spacing, Dim);
    P.volume[p] = std::pow(spacing, Dim);
    P.strength[p] = 1000.0;
    P.identity[p] = static_cast<std::int32_t>(p);
    for (int k = 0; k < 3; ++k) P.stress[k][p] = -5e3 * (1.0 + jitter(random));
  }
  return P;
}

// Linear and angular momentum; the affine velocity's spin counts with D = h^2 / 4 (Jiang et al. 2015, eq. 6).
template <int Dim>
std::vector<double> momenta(const Particles<Dim>& P, double h) {
  std::vector<double> sum(Dim, 0.0);
  for (std::size_t p = 0; p < P.count(); ++p)
    for (int d = 0; d < Dim; ++d) sum[d] += P.mass[p] * P.velocity[d][p];
  for (int i = 0; i < Dim; ++i)
    for (int j = i + 1; j < Dim; ++j) {
      double turn = 0.0;
      for (std::size_t p = 0; p < P.count(); ++p) {
        turn += P.mass[p] * (P.position[i][p] * P.velocity[j][p] - P.position[j][p] * P.velocity[i][p]);
        if (!P.affine[0].empty())
          turn += P.mass[p] * 0.25 * h * h * (P.affine[j * Dim + i][p] - P.affine[i * Dim + j][p]);
      }
      sum.push_back(turn);
    }
  return sum;
}

template <int Dim>
std::unique_ptr<Solver<Dim>> solver(const SolverOptions& o, double h, Particles<Dim> P, const char* law,
                                    const Terrain& terrain) {
  return make_solver<Dim>(o, h, {}, std::move(P), {soil(law)}, terrain, Walls<Dim>{});
}

// Particles from a file have velocities but no spin, and take it from the first grid; a step later nothing is lost.
// Those that start with spin lose nothing from the start.
template <int Dim>
void check_momenta_of_free_body(TransferName transfer, std::array<int, 3> count, bool with_spin) {
  CAPTURE(static_cast<int>(transfer));
  CAPTURE(with_spin);
  const Terrain none;
  SolverOptions o;
  o.transfer = transfer;
  Particles<Dim> P = block<Dim>(0.125, count, true);
  if (with_spin) P.affine[1] = P.velocity[0];  // 1/s, any numbers
  auto s = solver<Dim>(o, 0.25, std::move(P), "linear_elastic", none);
  s->start(1e30);
  if (!with_spin) s->step({}, {}, 1e30);
  const auto before = momenta<Dim>(s->particles(), 0.25);
  for (int i = 0; i < 200; ++i) s->step({}, {}, 1e30);
  const auto after = momenta<Dim>(s->particles(), 0.25);
  double size = 0.0;
  for (std::size_t p = 0; p < s->particles().count(); ++p) size += s->particles().mass[p] * 0.2 * 3.0;
  for (std::size_t k = 0; k < after.size(); ++k) CHECK(std::fabs(after[k] - before[k]) < 1e-12 * size);
}

}  // namespace

TEST_CASE("with APIC and AFLIP a free body keeps its linear and angular momentum to round-off, in 2-D and 3-D") {
  for (const TransferName transfer : {TransferName::apic, TransferName::aflip})
    for (const bool with_spin : {false, true}) {
      check_momenta_of_free_body<2>(transfer, {24, 16, 1}, with_spin);
      check_momenta_of_free_body<3>(transfer, {8, 10, 6}, with_spin);
    }
}

TEST_CASE("uniform motion stays uniform and free of stress, over many cells") {
  const Terrain none;
  for (const ShapeName shape : {ShapeName::quadratic, ShapeName::cubic}) {
    CAPTURE(static_cast<int>(shape));
    SolverOptions o;
    o.shape = shape;
    Particles<2> P = block<2>(0.125, {16, 16, 1}, true);
    for (std::size_t p = 0; p < P.count(); ++p) {
      P.velocity[0][p] = 3.0;
      P.velocity[1][p] = -1.5;
      for (auto& s : P.stress) s[p] = 0.0;
    }
    const double x0 = P.position[0][100];
    auto s = solver<2>(o, 0.25, std::move(P), "linear_elastic", none);
    s->start(1e30);
    double time = 0.0;
    for (int i = 0; i < 400; ++i) time += s->step({0, 0}, {0, 0}, 1e30).dt;
    for (std::size_t p = 0; p < s->particles().count(); ++p) {
      CHECK(std::fabs(s->particles().velocity[0][p] - 3.0) < 1e-11);
      CHECK(std::fabs(s->particles().stress[0][p]) < 1e-5);
      if (s->particles().identity[p] == 100)
        CHECK(s->particles().position[0][p] == doctest::Approx(x0 + 3.0 * time).epsilon(1e-11));
    }
    CHECK(s->sorts() > 3);
  }
}

TEST_CASE("the same bits for one thread and for two") {
  Terrain bed;
  bed.add_line({{{-10.0, 0.1}}, {{10.0, -0.3}}}, {0.4}, false);
  const int threads = omp_get_max_threads();
  std::array<std::vector<double>, 2> x;
  for (int t = 0; t < 2; ++t) {
    omp_set_num_threads(t + 1);
    auto s = solver<2>({}, 0.25, block<2>(0.125, {40, 30, 1}, true), "mohr_coulomb", bed);
    s->start(1e30);
    for (int i = 0; i < 150; ++i) s->step({0, -9.81}, {0, 0}, 1e30);
    x[t].assign(s->particles().position[0].begin(), s->particles().position[0].end());
  }
  omp_set_num_threads(threads);
  CHECK(x[0] == x[1]);
}

TEST_CASE("3-D: a free body keeps its momentum, gravity adds to it exactly") {
  const Terrain none;
  auto s = solver<3>({}, 0.25, block<3>(0.125, {8, 8, 8}, true), "linear_elastic", none);
  s->start(1e30);
  const auto sum = [&](int d) {
    double m = 0.0;
    for (std::size_t p = 0; p < s->particles().count(); ++p)
      m += s->particles().mass[p] * s->particles().velocity[d][p];
    return m;
  };
  double mass = 0.0, time = 0.0;
  for (const double m : s->particles().mass) mass += m;
  const double x = sum(0), y = sum(1), z = sum(2);
  for (int i = 0; i < 50; ++i) time += s->step({0, -9.81, 0}, {0, 0, 0}, 1e30).dt;
  CHECK(std::fabs(sum(0) - x) < 1e-11 * mass);
  CHECK(std::fabs(sum(1) - y + 9.81 * mass * time) < 1e-10 * mass);
  CHECK(std::fabs(sum(2) - z) < 1e-11 * mass);
}

TEST_CASE("FLIP keeps linear momentum") {
  const Terrain none;
  SolverOptions o;
  o.transfer = TransferName::flip;
  auto s = solver<2>(o, 0.25, block<2>(0.125, {16, 16, 1}, false), "linear_elastic", none);
  s->start(1e30);
  const auto before = momenta<2>(s->particles(), 0.25);
  for (int i = 0; i < 100; ++i) s->step({0, 0}, {0, 0}, 1e30);
  const auto after = momenta<2>(s->particles(), 0.25);
  for (int k = 0; k < 2; ++k) CHECK(std::fabs(after[k] - before[k]) < 1e-9);
}

TEST_CASE("shorter steps take more of a motion with APIC, but not with AFLIP") {
  const Terrain none;
  // Share of the energy that is left after the same time of a shear wave five cells long.
  const auto energy_left = [&](TransferName transfer, double courant) {
    SolverOptions o;
    o.transfer = transfer;
    o.courant = courant;
    Particles<2> P = block<2>(0.125, {80, 16, 1}, true);
    double start = 0.0;
    for (std::size_t p = 0; p < P.count(); ++p) {
      P.velocity[0][p] = 0.0;
      P.velocity[1][p] = 1e-3 * std::sin(2.0 * M_PI * P.position[0][p] / 1.25);
      for (auto& column : P.stress) column[p] = 0.0;
      start += P.velocity[1][p] * P.velocity[1][p];
    }
    auto s = solver<2>(o, 0.25, std::move(P), "linear_elastic", none);
    s->start(1e30);
    const auto energy = [&] {
      double sum = s->elastic_energy() / (0.5 * 2000.0 * 0.125 * 0.125);
      for (const auto& v : s->particles().velocity)
        for (const double x : v) sum += x * x;
      return sum;
    };
    for (double time = 0.0; time < 0.05;) time += s->step({0, 0}, {0, 0}, 0.05 - time > 0.0 ? 0.05 - time : 1e30).dt;
    return energy() / start;
  };
  CHECK(energy_left(TransferName::apic, 0.1) < 0.5 * energy_left(TransferName::apic, 0.6));
  CHECK(energy_left(TransferName::aflip, 0.1) > energy_left(TransferName::aflip, 0.6));
  CHECK(energy_left(TransferName::aflip, 0.6) > 1.5 * energy_left(TransferName::apic, 0.6));
}

TEST_CASE("particles are held at the domain's sides, stopped or removed, as asked") {
  const Terrain none;
  const auto moving = [&](LeavingParticles leaving) {
    Walls<2> walls;
    walls.bounded = true;
    walls.low = {-1.0, -1.0};
    walls.high = {3.0, 3.0};
    walls.leaving = leaving;
    Particles<2> P = block<2>(0.125, {16, 16, 1}, true);
    for (double& v : P.velocity[0]) v = 5.0;
    auto s = make_solver<2>({}, 0.25, {-1.0, -1.0}, std::move(P), {soil("linear_elastic")}, none, walls);
    s->start(1e30);
    for (int i = 0; i < 100; ++i) s->step({0, 0}, {0, 0}, 1e30);
    return s;
  };
  const auto held = moving(LeavingParticles::wall);
  CHECK(held->particles().count() == 256);
  CHECK(held->held().size() > 10);
  CHECK(held->work().removed > 0.0);
  for (const double x : held->particles().position[0]) CHECK(x <= 3.0);
  const auto fewer = moving(LeavingParticles::remove);
  CHECK(fewer->particles().count() + fewer->removed().size() == 256);
  CHECK(fewer->removed().size() > 10);
  CHECK_THROWS_WITH_AS(moving(LeavingParticles::error), doctest::Contains("left the domain"), std::runtime_error);
}

TEST_CASE("what a wall lets through by a hair is put back; by more, or at an open side, it has left") {
  const Terrain none;
  const auto after_a_step = [&](WallKind side, double cells) {
    Walls<2> walls;
    walls.bounded = true;
    walls.low = {0.0, -1.0};
    walls.high = {3.0, 3.0};
    walls.side[0][0].kind = side;
    Particles<2> P = block<2>(0.125, {16, 16, 1}, true);
    const std::size_t first = 0;
    P.position[0][first] = -cells * 0.25;
    auto s = make_solver<2>({}, 0.25, {0.0, -1.0}, std::move(P), {soil("linear_elastic")}, none, walls);
    s->start(1e30);
    s->step({0, 0}, {0, 0}, 1e30);
    double least = 1.0;
    for (const double x : s->particles().position[0]) least = std::min(least, x);
    return least;
  };
  CHECK(after_a_step(WallKind::slip, 0.05) == 0.0);
  CHECK_THROWS_WITH_AS(after_a_step(WallKind::slip, 0.3), doctest::Contains("left the domain"), std::runtime_error);
  CHECK_THROWS_WITH_AS(after_a_step(WallKind::open, 0.05), doctest::Contains("left the domain"), std::runtime_error);
}

TEST_CASE("a time step beyond the limit is caught with the particle's name, not carried on as garbage") {
  Terrain bed;
  bed.add_line({{{-10.0, 0.0}}, {{10.0, 0.0}}}, {0.4}, false);
  SolverOptions o;
  o.courant = 40.0;
  auto s = solver<2>(o, 0.25, block<2>(0.125, {16, 16, 1}, true), "linear_elastic", bed);
  s->start(1e30);
  CHECK_THROWS_WITH_AS(
      [&] {
        for (int i = 0; i < 2000; ++i) s->step({0, -9.81}, {0, 0}, 1e30);
      }(),
      doctest::Contains("particle "), std::runtime_error);
}

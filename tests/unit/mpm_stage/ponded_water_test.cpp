// Still water against the soil, for every dimension and transfer: Archimedes, thrust on one side, work and overtopping.
#include "mpm_stage/boundary/ponded_water.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/warnings.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.5, weight = 9810.0;

// A block of 4 x 5 m, in 3-D 2 m thick, with two particles along a cell's side; moved by `at` m.
template <int Dim>
Particles<Dim> block(double density, std::array<double, 2> at = {}) {
  const double spacing = 0.5 * h;
  const int nx = 16, ny = 20, nz = Dim == 3 ? 8 : 1;
  Particles<Dim> P;
  P.resize(static_cast<std::size_t>(nx * ny * nz), true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    const int i = static_cast<int>(p) % nx, j = static_cast<int>(p) / nx % ny, k = static_cast<int>(p) / nx / ny;
    P.position[0][p] = at[0] + (i + 0.5) * spacing;
    P.position[1][p] = at[1] + (j + 0.5) * spacing;
    if constexpr (Dim == 3) P.position[2][p] = (k + 0.5) * spacing;
    P.volume[p] = std::pow(spacing, Dim);
    P.mass[p] = density * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  return P;
}

Pond pond(double level, double x_to = Pond::endless) {
  Pond pond;
  pond.name = "reservoir";
  pond.time = {0.0};
  pond.level = {level};
  pond.high[0] = x_to;
  return pond;
}

template <int Dim>
std::unique_ptr<Solver<Dim>> solver(Particles<Dim> particles, SolverOptions options) {
  static const Terrain none;
  Material m;
  m.name = "soil";
  m.law = &law_named("linear_elastic");
  m.youngs_modulus = 1e7;
  m.poisson_ratio = 0.3;
  std::array<double, Dim> origin{};
  return make_solver<Dim>(options, h, origin, std::move(particles), {m}, none, Walls<Dim>{});
}

template <int Dim>
std::array<double, Dim> momentum(const Particles<Dim>& P) {
  std::array<double, Dim> sum{};
  for (std::size_t p = 0; p < P.count(); ++p)
    for (int d = 0; d < Dim; ++d) sum[d] += P.mass[p] * P.velocity[d][p];
  return sum;
}

// N, of the first step on a block that nothing else acts on.
template <int Dim>
std::array<double, Dim> first_force(const Pond& water, TransferName transfer, std::array<double, 2> at = {}) {
  SolverOptions o;
  o.transfer = transfer;
  o.ponds = {water};
  auto s = solver<Dim>(block<Dim>(2000.0, at), o);
  s->start(1e-4);
  s->step({}, {}, 1e-4);
  auto force = momentum<Dim>(s->particles());
  for (double& f : force) f /= 1e-4;
  return force;
}

}  // namespace

TEST_CASE("a block in deep water loses the weight of the water that it displaces, wherever it lies in the grid") {
  for (const TransferName transfer : {TransferName::aflip, TransferName::apic, TransferName::fmpm}) {
    CAPTURE(static_cast<int>(transfer));
    const auto f2 = first_force<2>(pond(9.0), transfer, {0.13, -0.21});
    CHECK(f2[1] == doctest::Approx(weight * 20.0).epsilon(1e-9));
    CHECK(std::fabs(f2[0]) < 1e-9 * weight * 20.0);
    const auto f3 = first_force<3>(pond(9.0), transfer, {0.13, -0.21});
    CHECK(f3[1] == doctest::Approx(weight * 40.0).epsilon(1e-9));
    CHECK(std::fabs(f3[0]) + std::fabs(f3[2]) < 1e-9 * weight * 40.0);
  }
}

TEST_CASE("water on one side pushes with half gamma H^2 per metre, and not at all from a level below the foot") {
  tailrun::forget_warnings();
  const auto f2 = first_force<2>(pond(4.0, 2.0), TransferName::aflip);
  CHECK(f2[0] == doctest::Approx(0.5 * weight * 16.0).epsilon(1e-9));
  const auto f3 = first_force<3>(pond(4.0, 2.0), TransferName::aflip);
  CHECK(f3[0] == doctest::Approx(0.5 * weight * 16.0 * 2.0).epsilon(1e-9));
  const auto none = first_force<2>(pond(-0.5, 2.0), TransferName::aflip);
  CHECK(none[0] == 0.0);
  CHECK(none[1] == 0.0);
  tailrun::forget_warnings();
}

TEST_CASE("what the water gives to a body that floats up is booked as external work") {
  SolverOptions o;
  o.transfer = TransferName::apic;
  o.ponds = {pond(12.0)};
  // It begins with the water's pressure in it: a shock would be lost in the transfer.
  auto start = block<2>(500.0);
  for (std::size_t p = 0; p < start.count(); ++p)
    for (std::size_t k = 0; k < 3; ++k) start.stress[k][p] = -weight * (12.0 - start.position[1][p]);
  auto s = solver<2>(std::move(start), o);
  s->start(1e30);
  const double elastic = s->elastic_energy();
  double time = 0.0;
  // Far enough for sorts, not far enough for the surface.
  while (time < 0.5) time += s->step({0.0, -9.81}, {}, 1e30).dt;
  REQUIRE(s->sorts() > 1);
  double rise = 0.0, kinetic = 0.0;
  for (std::size_t p = 0; p < s->particles().count(); ++p) {
    const auto& P = s->particles();
    rise += (P.position[1][p] - (0.5 + static_cast<double>(P.identity[p] / 16)) * 0.25) / 320.0;
    kinetic += 0.5 * P.mass[p] * (std::pow(P.velocity[0][p], 2) + std::pow(P.velocity[1][p], 2));
  }
  CHECK(rise == doctest::Approx(0.5 * 9.81 * 0.25).epsilon(0.03));  // g (rho_w / rho - 1) = g
  const double gained = kinetic + 500.0 * 20.0 * 9.81 * rise + s->elastic_energy() - elastic;
  CHECK(s->work().external == doctest::Approx(gained).epsilon(0.02));
}

TEST_CASE("a level that falls is followed between sorts, and a sleeping body feels it") {
  SolverOptions o;
  Pond falling = pond(9.0);
  falling.time = {0.0, 0.5, 1.0};
  falling.level = {9.0, 9.0, 1.0};
  o.ponds = {falling};
  CHECK(falling.level_at(0.75) == 5.0);
  CHECK(falling.level_at(7.0) == 1.0);
  o.sleep.speed = 1e-3;
  o.sleep.calm = 0.05;
  o.sleep.nap = 1e3;
  // As heavy as water: at rest until the level goes below the top. It begins with the water's pressure in it.
  auto P = block<2>(1000.0);
  for (std::size_t p = 0; p < P.count(); ++p)
    for (int k = 0; k < 3; ++k) P.stress[static_cast<std::size_t>(k)][p] = -weight * (9.0 - P.position[1][p]);
  auto s = solver<2>(std::move(P), o);
  s->start(1e30);
  double time = 0.0;
  std::size_t asleep = 0;
  while (time < 0.5) {
    const StepReport r = s->step({0.0, -9.81}, {}, 1e30);
    time += r.dt;
    asleep = std::max(asleep, r.asleep);
  }
  CHECK(asleep == 320);
  while (time < 1.2) time += s->step({0.0, -9.81}, {}, 1e30).dt;
  CHECK(s->ponds()[0].level == 1.0);
  CHECK(momentum<2>(s->particles())[1] < -0.1 * 20000.0);  // falls
}

TEST_CASE("soil that has sunk below the level lets the water out: said once, with time and place") {
  tailrun::forget_warnings();
  SolverOptions o;
  o.ponds = {pond(5.2, 2.0)};
  auto s = solver<2>(block<2>(2000.0), o);
  s->start(1e30);
  CHECK(s->ponds()[0].escaped == 0.0);
  CHECK(s->ponds()[0].place[0] == doctest::Approx(2.0));
  REQUIRE(tailrun::warnings().size() == 1);
  CHECK(tailrun::warnings()[0].find("'reservoir'") != std::string::npos);
  double time = 0.0;
  while (time < 0.2) time += s->step({0.0, -9.81}, {}, 1e30).dt;
  CHECK(tailrun::warnings().size() == 1);
  tailrun::forget_warnings();
}

#include "mpm_stage/output/ledger.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "common/error.hpp"
#include "mpm_stage/output/energy_watch.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

constexpr double h = 0.25, spacing = 0.125;

// Particles at rest, free of stress, in boxes of `count` from (0, 0, 0) on; jittered, so that nothing is symmetric.
template <int Dim>
Particles<Dim> block(std::array<int, 3> count) {
  Particles<Dim> P;
  P.resize(static_cast<std::size_t>(count[0] * count[1] * (Dim == 3 ? count[2] : 1)), true, false);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> off(-0.2, 0.2);
  for (std::size_t p = 0; p < P.count(); ++p) {
    std::size_t rest = p;
    for (int d = 0; d < Dim; ++d) {
      P.position[d][p] = (static_cast<double>(rest % count[d]) + 0.5 + off(random)) * spacing;
      P.velocity[d][p] = off(random);
      rest /= static_cast<std::size_t>(count[d]);
    }
    P.volume[p] = std::pow(spacing, Dim);
    P.mass[p] = 2000.0 * P.volume[p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  return P;
}

Material elastic(double youngs_modulus) {
  Material m;
  m.name = "rubber";
  m.law = &law_named("linear_elastic");
  m.youngs_modulus = youngs_modulus;
  m.poisson_ratio = 0.3;
  return m;
}

template <int Dim>
Walls<Dim> box() {
  Walls<Dim> walls;
  walls.bounded = true;
  walls.low.fill(-4.0);
  walls.high.fill(8.0);
  return walls;
}

template <int Dim>
struct Account {
  std::unique_ptr<Solver<Dim>> solver;
  Ledger<Dim> ledger{std::array<double, Dim>{}};
  double time = 0.0;

  Account(const SolverOptions& o, Particles<Dim> P, double youngs_modulus, const Terrain& ground,
          const Walls<Dim>& walls)
      : solver(make_solver<Dim>(o, h, {}, std::move(P), {elastic(youngs_modulus)}, ground, walls)) {
    solver->start(1e30);
    ledger.sample(0.0, *solver, 0.02);
  }
  const LedgerRow& step(int count) {
    for (int i = 0; i < count; ++i) time += solver->step({}, {}, 5e-3).dt;
    return ledger.sample(time, *solver, 0.02);
  }
};

SolverOptions with(TransferName transfer) {
  SolverOptions o;
  o.transfer = transfer;
  o.maximum_step = 5e-3;
  o.local_damping = transfer == TransferName::apic ? 1e-12 : 0.0;  // APIC with momentum and forces apart
  o.surface_share = 0.0;
  return o;
}

// Dust (hardly any stiffness) thrown at sloping ground, or at the domain's left side: all that it loses is booked.
template <int Dim>
void check_dust(TransferName transfer, WallKind side, double surface_share) {
  const bool at_ground = side == WallKind::open;
  Terrain ground;
  if (at_ground) ground.add_line({{{-10.0, -0.05}}, {{20.0, -0.45}}}, {0.5}, false);
  Walls<Dim> walls = box<Dim>();
  if (!at_ground) walls.low[0] = -0.25;
  walls.side[0][0] = {side, 0.3};
  Particles<Dim> P = block<Dim>({12, 8, 4});
  for (double& v : P.velocity[0]) v -= 2.0;
  for (double& v : P.velocity[1]) v -= 2.0;
  SolverOptions o = with(transfer);
  o.surface_share = surface_share;
  Account<Dim> run(o, std::move(P), 1e-14, ground, walls);
  const LedgerRow& row = run.step(40);
  const double start = run.ledger.rows().front().kinetic;
  CHECK(row.work.transfer > 1e-3 * start);
  const bool mirror = side == WallKind::slip || side == WallKind::fixed;
  CHECK((mirror ? std::fabs(row.work.impact) < 1e-30 * start : row.work.impact > 0.002 * start));
  CHECK((mirror ? row.work.friction == 0.0 : row.work.friction > 0.02 * start));
  CHECK(std::fabs(row.residual) < 1e-11 * start);
}

// A rigid box to the left of x = 0.
MovingBody<2> plate(std::array<double, 2> velocity) {
  return {"plate", {-1.0, -1.0}, {0.0, 3.0}, {0.0}, {velocity}};
}

}  // namespace

TEST_CASE("where nothing is elastic, transfer, impacts and friction explain every joule") {
  for (const TransferName transfer : {TransferName::aflip, TransferName::flip, TransferName::apic}) {
    CAPTURE(static_cast<int>(transfer));
    for (const WallKind side : {WallKind::open, WallKind::frictional, WallKind::slip, WallKind::fixed}) {
      CAPTURE(static_cast<int>(side));
      check_dust<2>(transfer, side, 0.0);
      if (side == WallKind::open || side == WallKind::frictional) check_dust<2>(transfer, side, 0.1);
      check_dust<3>(transfer, side, 0.0);
    }
  }
}

TEST_CASE("what a moving plate gives to dust that it hits is its work less the impact") {
  Walls<2> walls = box<2>();
  walls.bodies.push_back(plate({1.5, 0.2}));
  const Terrain none;
  Account<2> run(with(TransferName::aflip), block<2>({12, 8, 1}), 1e-14, none, walls);
  const LedgerRow& row = run.step(40);
  CHECK(row.work.external > 10.0);
  CHECK(row.work.impact > 1.0);
  CHECK(std::fabs(row.residual) < 1e-11 * row.work.external);
}

TEST_CASE("where a plate holds dust on sloping ground, friction costs what the plate's motion makes of it") {
  Terrain ground;
  ground.add_line({{{-10.0, -0.05}}, {{20.0, -0.45}}}, {0.5}, false);
  for (const TransferName transfer : {TransferName::aflip, TransferName::apic})
    for (const std::array<double, 2> velocity : {std::array{0.0, 0.0}, {1.5, 0.2}, {-1.0, 0.0}}) {
      CAPTURE(static_cast<int>(transfer));
      CAPTURE(velocity[0]);
      Walls<2> walls = box<2>();
      walls.bodies.push_back(plate(velocity));
      walls.low[0] = -0.25;
      walls.side[0][0] = {WallKind::frictional, 0.3};
      Particles<2> P = block<2>({12, 8, 1});
      for (double& v : P.velocity[0]) v -= 2.0;
      for (double& v : P.velocity[1]) v -= 2.0;
      Account<2> run(with(transfer), std::move(P), 1e-14, ground, walls);
      const LedgerRow& row = run.step(40);
      const LedgerRow& start = run.ledger.rows().front();
      CHECK(row.work.friction > 10.0);
      for (int d = 0; d < 2; ++d)
        CHECK(row.momentum[d] - start.momentum[d] ==
              doctest::Approx(run.solver->boundary_impulse()[d] - run.solver->bodies()[0].impulse[d]).epsilon(1e-10));
      CHECK(std::fabs(row.residual) < 1e-11 * start.kinetic);
    }
}

TEST_CASE("a body that shakes loses its energy in the transfer; what is left to the residual is small") {
  const Terrain none;
  Account<2> run(with(TransferName::aflip), block<2>({24, 16, 1}), 1e6, none, box<2>());
  const LedgerRow& row = run.step(400);
  const double start = run.ledger.rows().front().kinetic;
  CHECK(row.work.transfer > 0.5 * start);
  CHECK(std::fabs(row.residual) < 0.1 * row.lost);
}

TEST_CASE("local damping costs nothing where ground holds the soil") {
  // Soil laid down on rough ground without the stress of its weight settles, rings, and is damped to rest.
  Terrain ground;
  ground.add_line({{-10.0, 0.0}, {20.0, 0.0}}, {0.5}, false);
  SolverOptions o = with(TransferName::aflip);
  o.local_damping = 0.3;
  o.maximum_step = 1e30;
  Particles<2> P = block<2>({24, 16, 1});
  for (auto& column : P.velocity) std::fill(column.begin(), column.end(), 0.0);
  const std::array<double, 2> gravity = {0.0, -9.81};
  auto solver = make_solver<2>(o, h, {}, std::move(P), {elastic(1e6)}, ground, box<2>());
  Ledger<2> ledger(gravity);
  solver->start(1e30);
  ledger.sample(0.0, *solver, 0.02);
  for (double t = 0.0; t < 1.0;) t += solver->step(gravity, {}, 1e30).dt;
  const LedgerRow& row = ledger.sample(1.0, *solver, 0.02);
  const double settled = ledger.rows().front().gravitational - row.gravitational;
  CHECK(settled > 0.0);
  CHECK(row.work.damping > 0.1 * settled);
  CHECK(row.work.damping < 0.6 * settled);
  CHECK(std::fabs(row.residual) < 0.05 * settled);
}

TEST_CASE("FMPM cannot tell transfer and impacts from the residual, and says so") {
  const Terrain none;
  Account<2> run(with(TransferName::fmpm), block<2>({24, 16, 1}), 1e6, none, box<2>());
  const LedgerRow& row = run.step(10);
  CHECK(std::isnan(row.work.transfer));
  const auto path = std::filesystem::temp_directory_path() / "tailrun_ledger_test.csv";
  run.ledger.write(path);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  CHECK(text.str().find(",,,") != std::string::npos);
  CHECK(text.str().find("nan") == std::string::npos);
  std::filesystem::remove(path);
  CHECK(row.residual == row.lost);
  CHECK(row.lost > 0.0);
}

TEST_CASE("when energy grows from nothing, the particle that has it is named, with place, material and energies") {
  const Terrain none;
  Account<2> run(with(TransferName::aflip), block<2>({24, 16, 1}), 1e6, none, box<2>());
  run.step(1);
  Particles<2>& P = run.solver->particles();
  std::size_t fast = 0;
  while (P.identity[fast] != 77) ++fast;
  P.velocity[0][fast] = 300.0;
  const std::string expected = "particle 77 of material 'rubber' at (";
  CHECK_THROWS_WITH_AS(run.ledger.sample(run.time, *run.solver, 0.02), doctest::Contains(expected.c_str()),
                       ComputationError);
  CHECK_THROWS_WITH_AS(run.ledger.sample(run.time, *run.solver, 0.02), doctest::Contains("kinetic energy of 1.4"),
                       ComputationError);
  CHECK_THROWS_WITH_AS(run.ledger.look(run.time, *run.solver, 0.02), doctest::Contains("energy has grown"),
                       ComputationError);
  CHECK(run.ledger.rows().size() == 4);
  P.velocity[0][fast] = 0.0;
  P.stress[0][fast] = -1e8;
  CHECK_THROWS_WITH_AS(run.ledger.sample(run.time, *run.solver, 0.02), doctest::Contains(expected.c_str()),
                       ComputationError);
}

TEST_CASE("the amount in the message is the one that is beyond the limit") {
  const Terrain none;
  Account<2> run(with(TransferName::aflip), block<2>({24, 16, 1}), 1e6, none, box<2>());
  run.step(1);
  // Half of what a step gains counts, and next to nothing has been lost or made besides.
  run.ledger.follow(0.0);
  run.ledger.follow(2e6);
  std::string message;
  try {
    run.ledger.look(run.time, *run.solver, 0.02);
  } catch (const ComputationError& error) {
    message = error.what();
  }
  CHECK_MESSAGE(message.find("by 1e+06 J of") != std::string::npos, message);
}

TEST_CASE("a look is called for by what a step reports, and every so many steps") {
  EnergyWatch watch;
  LedgerRow row;
  row.elastic = 10.0;
  StepReport report;
  report.dt = 1e-3;
  report.kinetic_energy = 100.0;
  WorkDone work;
  watch.looked(report, row, 9.81 * std::sqrt(50.0), 2.0);
  // Gravity may give 9.81 sqrt(2 50 100) 1e-3 = 0.98 J in a step, the stresses gave 10 J, half of 2 J may come from
  // nothing.
  report.kinetic_energy = 111.0;
  CHECK(!watch.due(report, work));
  work.plastic = 3.0;
  CHECK(watch.due(report, work));
  work.external = 3.0;
  CHECK(!watch.due(report, work));
  int quiet = 3;
  while (!watch.due(report, work)) ++quiet;
  CHECK(quiet + 1 == EnergyWatch::steps);
}

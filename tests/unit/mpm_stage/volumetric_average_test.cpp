#include "mpm_stage/transfer/volumetric_average.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/material/mean_stress_relaxation.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

using Shape = QuadraticShape;
constexpr double h = 0.5, density = 1900.0, gravity = -9.81;
constexpr std::array<double, 2> corner = {0.0, 0.0};

// 10 x 10 particles, each somewhere in its own square, in the lower left of a tile.
Particles<2> scattered() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(0.05, 0.95);
  Particles<2> P;
  P.resize(100, true, false);
  for (std::size_t p = 0; p < 100; ++p) {
    P.position[0][p] = h + 0.25 * (static_cast<double>(p % 10) + jitter(random));
    P.position[1][p] = h + 0.25 * (static_cast<double>(p / 10) + jitter(random));
    P.volume[p] = 0.0625 * jitter(random);
    P.mass[p] = density * P.volume[p];
  }
  return P;
}

struct Averages {
  std::vector<double> trace, shift;
};

Averages averages(const Particles<2>& P, const std::array<double, 2>& body) {
  constexpr int nodes = Tile<2, Shape>::nodes;
  AlignedVector<AveragedNode> sums(nodes, AveragedNode{});
  scatter_volumetric<2, Shape>(P, 0, P.count(), corner, 1.0 / h, body, sums.data());
  AlignedVector<Vec4> mean;
  for (const AveragedNode& node : sums) mean.push_back(twice(node_mean(node)));
  Averages out{std::vector<double>(P.count()), std::vector<double>(P.count())};
  gather_volumetric<2, Shape>(P, 0, P.count(), corner, 1.0 / h, 1.0, mean.data(), out.trace.data(), out.shift.data());
  return out;
}

}  // namespace

TEST_CASE("averaging the volumetric increments keeps the change of volume") {
  Particles<2> P = scattered();
  std::mt19937 random(2);
  std::normal_distribution<double> increment(1e-3, 1e-3);
  double wanted = 0.0, found = 0.0, before = 0.0, after = 0.0;
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.gradient[0][p] = increment(random);
    P.gradient[3][p] = increment(random);
  }
  const Averages a = averages(P, {0.0, 0.0});
  for (std::size_t p = 0; p < P.count(); ++p) {
    wanted += P.volume[p] * trace_of(P, p);
    found += P.volume[p] * a.trace[p];
    before += P.volume[p] * trace_of(P, p) * trace_of(P, p);
    after += P.volume[p] * a.trace[p] * a.trace[p];
  }
  CHECK(found == doctest::Approx(wanted).epsilon(1e-12));
  CHECK(after < before);
}

TEST_CASE("a hydrostatic body feels no relaxation, not even at its surface") {
  Particles<2> P = scattered();
  for (std::size_t p = 0; p < P.count(); ++p)
    for (int k = 0; k < 3; ++k) P.stress[k][p] = density * gravity * (4.0 - P.position[1][p]);
  for (const double shift : averages(P, {0.0, gravity}).shift) CHECK(std::fabs(shift) < 1e-8);
  double largest = 0.0;
  for (const double shift : averages(P, {0.0, 0.0}).shift) largest = std::max(largest, std::fabs(shift));
  CHECK(largest > 1000.0);  // Pa; without gravity the same stresses are noise
}

TEST_CASE("mean stress relaxes by the share of its strength that the soil uses, fully from half of it") {
  Particles<2> P;
  P.resize(4, false, false);
  MaterialConstants soft;
  soft.softens = true;
  soft.soften_scale = 0.1;
  soft.cohesion_ratio = 0.5;
  const double shear[] = {0.0, 250.0, 600.0, 0.0};  // Pa
  for (std::size_t p = 0; p < 4; ++p) {
    P.strength[p] = p == 3 ? 0.0 : 1000.0;
    P.stress[3][p] = shear[p];
    for (int k = 0; k < 3; ++k) P.stress[k][p] = -5e4;
  }
  P.plastic_strain[1] = 1.0;
  std::vector<double> stiff_share(4, 1.0), soft_share(4, 1.0);
  relax_by_used_strength(MaterialConstants{}, P, 0, 4, stiff_share.data());
  relax_by_used_strength(soft, P, 0, 4, soft_share.data());
  CHECK(stiff_share == std::vector<double>{0.0, 0.25, 1.0, 1.0});  // without strength soil always flows
  CHECK(soft_share == std::vector<double>{0.0, 1.0, 1.0, 1.0});    // softened to 500 Pa
}

TEST_CASE("a strong block under its weight gains no energy from the relaxation of its mean stress") {
  Material clay;
  clay.name = "clay";
  clay.law = &law_named("tresca");
  clay.youngs_modulus = 5e6;
  clay.poisson_ratio = 0.33;
  Particles<2> P;
  P.resize(512, true, false);
  for (std::size_t p = 0; p < 512; ++p) {
    P.position[0][p] = 0.125 * (static_cast<double>(p % 32) + 0.5);
    P.position[1][p] = 0.125 * (static_cast<double>(p / 32) + 0.5);
    P.volume[p] = 0.125 * 0.125;
    P.mass[p] = density * P.volume[p];
    P.strength[p] = 1e5;
    P.stress[1][p] = density * gravity * (2.0 - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = 0.5 * P.stress[1][p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  Terrain bed;
  bed.add_line({{-10.0, 0.0}, {10.0, 0.0}}, {0.35}, false);
  auto s = make_solver<2>(SolverOptions{}, 0.25, {}, std::move(P), {clay}, bed, Walls<2>{});
  const auto energy = [&](double kinetic) {
    const Particles<2>& now = s->particles();
    double potential = 0.0;
    for (std::size_t p = 0; p < now.count(); ++p) potential -= now.mass[p] * gravity * now.position[1][p];
    return kinetic + s->elastic_energy() + potential;
  };
  s->start(1e30);
  const double first = energy(0.0), weight = density * 8.0 * -gravity;
  double most = first;
  for (double t = 0.0; t < 1.5;) {
    const StepReport report = s->step({0.0, gravity}, {0.0, 0.0}, 1e30);
    t += report.dt;
    most = std::max(most, energy(report.kinetic_energy));
  }
  CHECK(most - first < 1e-6 * weight);  // of the weight's work over a metre
  CHECK(energy(0.0) < first);
}

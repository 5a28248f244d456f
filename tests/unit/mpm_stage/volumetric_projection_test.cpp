#include "mpm_stage/transfer/volumetric_projection.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mpm_stage/grid/shape_functions.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;

namespace {

constexpr double h = 0.5, density = 1900.0, gravity = 9.81;

Material clay(double youngs_modulus) {
  Material m;
  m.name = "clay";
  m.law = &law_named("tresca");
  m.youngs_modulus = youngs_modulus;
  m.poisson_ratio = 0.33;
  return m;
}

// `side` particles a side, each somewhere in its own cell of h / 2, in a tile that begins at 0.
template <int Dim>
Particles<Dim> scattered(int side) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(0.05, 0.95);
  Particles<Dim> P;
  P.resize(static_cast<std::size_t>(std::pow(side, Dim)), true, false);
  for (std::size_t p = 0; p < P.count(); ++p) {
    std::size_t rest = p;
    for (int d = 0; d < Dim; ++d, rest /= static_cast<std::size_t>(side))
      P.position[d][p] =
          2.0 * h + 0.5 * h * (static_cast<double>(rest % static_cast<std::size_t>(side)) + jitter(random));
    P.volume[p] = std::pow(0.5 * h, Dim) * jitter(random);
    P.mass[p] = density * P.volume[p];
  }
  return P;
}

// Increments e' of the particles, whose first `soft` ones are of the first material.
template <int Dim, class Shape>
std::vector<double> projected(const Particles<Dim>& P, const MaterialConstants& first, const MaterialConstants& second,
                              std::size_t soft) {
  constexpr int nodes = Tile<Dim, Shape>::nodes, B = Block<Dim>::cells, T = Tile<Dim, Shape>::side;
  constexpr std::array<double, Dim> corner{};
  AlignedVector<PatchSum> sums(nodes, PatchSum{}), own(Block<Dim>::nodes);
  scatter_volumetric<Dim, Shape>(first, P, 0, soft, corner, 1.0 / h, sums.data());
  scatter_volumetric<Dim, Shape>(second, P, soft, P.count(), corner, 1.0 / h, sums.data());
  AlignedVector<PatchFit> fits(Block<Dim>::nodes), tile(nodes, PatchFit{});
  const auto place = [](int n) {
    int at = 0;
    for (int d = 0, stride = 1; d < Dim; ++d, stride *= T, n /= B) at += (n % B + 2) * stride;
    return at;
  };
  for (int n = 0; n < Block<Dim>::nodes; ++n) own[n] = sums[place(n)];
  fit_patches<Dim>(own.data(), fits.data());
  for (int n = 0; n < Block<Dim>::nodes; ++n) tile[place(n)] = fits[n];
  std::vector<double> increment(P.count());
  gather_volumetric<Dim, Shape>(first, P, 0, soft, corner, 1.0 / h, tile.data(), 0.0, increment.data());
  gather_volumetric<Dim, Shape>(second, P, soft, P.count(), corner, 1.0 / h, tile.data(), 0.0, increment.data() + soft);
  return increment;
}

template <int Dim>
double stress_of(const Particles<Dim>& P, std::size_t p) {
  return Dim == 2 ? 0.5 * (P.stress[0][p] + P.stress[1][p]) : (P.stress[0][p] + P.stress[1][p] + P.stress[2][p]) / 3.0;
}

template <int Dim, class Shape>
void check_energy() {
  Particles<Dim> P = scattered<Dim>(Dim == 2 ? 12 : 6);
  const MaterialConstants k[2] = {constants_of(clay(5e6), h), constants_of(clay(2e7), h)};
  const double K[2] = {VolumetricLaw<Dim>(k[0]).modulus, VolumetricLaw<Dim>(k[1]).modulus};
  const std::size_t soft = P.count() / 3;
  std::mt19937 random(2);
  std::normal_distribution<double> increment(1e-4, 1e-3), stress(-2e4, 1e4);
  for (std::size_t p = 0; p < P.count(); ++p) {
    for (int d = 0; d < Dim; ++d) P.gradient[d * (Dim + 1)][p] = increment(random);
    for (int c = 0; c < 3; ++c) P.stress[c][p] = stress(random);
  }
  const std::vector<double> e = projected<Dim, Shape>(P, k[0], k[1], soft);
  double wanted = 0.0, found = 0.0, plain = 0.0, after = 0.0;
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double modulus = K[p >= soft], own = trace_of(P, p), s = stress_of(P, p);
    wanted += P.volume[p] * own;
    found += P.volume[p] * e[p];
    plain += P.volume[p] / modulus * std::pow(s + modulus * own, 2);
    after += P.volume[p] / modulus * std::pow(s + modulus * e[p], 2);
  }
  CHECK(found == doctest::Approx(wanted).epsilon(1e-9));
  CHECK(after < 0.95 * plain);
  // What has been projected once stays.
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double s = stress_of(P, p) + K[p >= soft] * e[p];
    for (int c = 0; c < 3; ++c) P.stress[c][p] = s;
    for (int d = 0; d < Dim; ++d) P.gradient[d * (Dim + 1)][p] = 0.0;
  }
  for (const double again : projected<Dim, Shape>(P, k[0], k[1], soft)) CHECK(std::fabs(again) < 1e-10);
}

template <int Dim, class Shape>
void check_fixed_point() {
  Particles<Dim> P = scattered<Dim>(Dim == 2 ? 11 : 5);
  for (std::size_t p = 0; p < P.count(); ++p)
    for (int c = 0; c < 3; ++c)
      P.stress[c][p] = -density * gravity * (4.0 - P.position[1][p]) + 300.0 * P.position[0][p];
  const MaterialConstants k = constants_of(clay(5e6), h), stiff = constants_of(clay(5e7), h);
  for (const double e : projected<Dim, Shape>(P, k, stiff, P.count() / 2)) CHECK(std::fabs(e) < 1e-11);
}

}  // namespace

TEST_CASE("the projection keeps the change of volume, shortens what is stored, and leaves alone what it has made") {
  check_energy<2, QuadraticShape>();
  check_energy<2, LinearShape>();
  check_energy<3, QuadraticShape>();
  check_energy<3, CubicShape>();
}

TEST_CASE("a linear stress is a fixed point of the projection, up to the surface, whatever the stiffness") {
  check_fixed_point<2, QuadraticShape>();
  check_fixed_point<2, CubicShape>();
  check_fixed_point<3, QuadraticShape>();
  check_fixed_point<3, LinearShape>();
}

TEST_CASE("a lone particle and particles in a row are left as they are") {
  Particles<2> P = scattered<2>(3);
  for (std::size_t p = 0; p < P.count(); ++p) {
    P.position[0][p] = 2.1 * h + 0.1 * h * static_cast<double>(p);
    P.position[1][p] = 2.3 * h;
    P.stress[0][p] = P.stress[1][p] = -1e4 + 500.0 * static_cast<double>(p);
  }
  const MaterialConstants k = constants_of(clay(5e6), h);
  for (const double e : projected<2, QuadraticShape>(P, k, k, 9)) CHECK(std::fabs(e) < 1e-9);
  P.resize(1, true, false);
  P.position[0][0] = P.position[1][0] = 2.2 * h;
  P.volume[0] = 0.01;
  P.stress[0][0] = P.stress[1][0] = -3e4;
  P.gradient[0][0] = 1e-3;
  CHECK(projected<2, QuadraticShape>(P, k, k, 1)[0] == doctest::Approx(1e-3).epsilon(1e-9));
}

// From K0 = 0.5 the block rings a little, and that is all.
TEST_CASE("a block of clay with twice the strength that it needs stands and gains no energy") {
  Particles<2> P;
  P.resize(512, true, false);
  for (std::size_t p = 0; p < 512; ++p) {
    P.position[0][p] = 0.125 * (static_cast<double>(p % 32) + 0.5);
    P.position[1][p] = 0.125 * (static_cast<double>(p / 32) + 0.5);
    P.volume[p] = 0.125 * 0.125;
    P.mass[p] = density * P.volume[p];
    P.strength[p] = 2e4;
    P.stress[1][p] = -density * gravity * (2.0 - P.position[1][p]);
    P.stress[0][p] = P.stress[2][p] = 0.49 * P.stress[1][p];
    P.identity[p] = static_cast<std::int32_t>(p);
  }
  Terrain bed;
  bed.add_line({{-10.0, 0.0}, {10.0, 0.0}}, {0.35}, false);
  for (const TransferName transfer : {TransferName::aflip, TransferName::apic, TransferName::flip}) {
    SolverOptions o;
    o.transfer = transfer;
    auto s = make_solver<2>(o, 0.25, {}, Particles<2>(P), {clay(5e6)}, bed, Walls<2>{});
    const auto energy = [&](double kinetic) {
      const Particles<2>& now = s->particles();
      double potential = 0.0;
      for (std::size_t p = 0; p < now.count(); ++p) potential += now.mass[p] * gravity * now.position[1][p];
      return kinetic + s->elastic_energy() + potential;
    };
    s->start(1e30);
    const double first = energy(0.0), weight = density * 8.0 * gravity;
    double most = first, kinetic = 0.0;
    for (double t = 0.0; t < 3.0;) {
      const StepReport report = s->step({0.0, -gravity}, {0.0, 0.0}, 1e30);
      t += report.dt;
      kinetic = report.kinetic_energy;
      most = std::max(most, energy(kinetic));
    }
    CHECK(most - first < 1e-6 * weight);  // of the weight's work over a metre
    CHECK(kinetic < 2e-4 * weight);
  }
}

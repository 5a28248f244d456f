// The returns of Mohr-Coulomb and Tresca in principal stresses, as their laws' loops take them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mpm_stage/material/principal_stress.hpp"

using namespace tailrun::mpm;

namespace {

MaterialConstants constants(double phi, double psi, double nu) {
  Material m;
  m.law = &law_named("mohr_coulomb");
  m.youngs_modulus = 1e7;
  m.poisson_ratio = nu;
  m.friction_angle = phi;
  m.dilation_angle = psi;
  return constants_of(m, 1.0);
}

Principal sorted(double a, double b, double c) {
  return {std::max({a, b, c}), std::max(std::min(a, b), std::min(std::max(a, b), c)), std::min({a, b, c})};
}

// The pyramid k s1 - s3 = 2 c sqrt(k) of a friction angle (degrees).
struct Pyramid {
  double k, root2;
  explicit Pyramid(double phi) {
    const double sin_phi = std::sin(phi * std::numbers::pi / 180.0);
    k = (1.0 + sin_phi) / (1.0 - sin_phi);
    root2 = 2.0 * std::sqrt(k);
  }
};

// Pa, distance from the yield surface: above 0 outside.
double yield(const Pyramid& s, double c, Principal p) {
  return s.k * p.s1 - p.s3 - s.root2 * c;
}

Principal return_mohr_coulomb(const MaterialConstants& k, double c, Principal trial) {
  return law_named("mohr_coulomb").returned(k, c, trial);
}

}  // namespace

TEST_CASE("a million random trials return to the Mohr-Coulomb pyramid, in order") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0;
  long unordered = 0;
  for (const double phi : {5.0, 19.8, 35.0, 50.0}) {
    const MaterialConstants k = constants(phi, 0.3 * phi, 0.3);
    const Pyramid s(phi);
    for (int i = 0; i < 250000; ++i) {
      const double c = 1e4, size = std::pow(10.0, 4.5 + unit(random));
      const Principal t = sorted(size * unit(random), size * unit(random), size * unit(random));
      const Principal r = return_mohr_coulomb(k, c, t);
      worst = std::max(worst, yield(s, c, r) / c);
      unordered += !(r.s1 >= r.s2 - 1e-9 * c && r.s2 >= r.s3 - 1e-9 * c);
      if (yield(s, c, t) <= 0.0) CHECK((r.s1 == t.s1 && r.s2 == t.s2 && r.s3 == t.s3));
    }
  }
  CHECK(worst <= 1e-10);
  CHECK(unordered == 0);
}

// Associated flow: the return is the closest point of the convex pyramid in the energy norm, so no admissible stress
// may be nearer (de Souza Neto et al. 2008, 7.2.3).
TEST_CASE("with associated flow no admissible stress is nearer in the energy norm") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const MaterialConstants k = constants(30.0, 30.0, 0.25);
  const Pyramid s(30.0);
  const auto energy = [&](Principal a, Principal b) {
    const double d1 = a.s1 - b.s1, d2 = a.s2 - b.s2, d3 = a.s3 - b.s3, mean = (d1 + d2 + d3) / 3.0;
    const double e1 = d1 - mean, e2 = d2 - mean, e3 = d3 - mean;
    return 0.25 / k.mu * (e1 * e1 + e2 * e2 + e3 * e3) + 0.5 * mean * mean / k.bulk;
  };
  const double c = 1e4;
  for (int i = 0; i < 3000; ++i) {
    const Principal t = sorted(1e5 * unit(random), 1e5 * unit(random), 1e5 * unit(random));
    if (yield(s, c, t) <= 0.0) continue;
    const Principal r = return_mohr_coulomb(k, c, t);
    const double found = energy(t, r);
    for (int j = 0; j < 60; ++j) {
      const double near = std::pow(10.0, 2.0 + 1.5 * unit(random));
      const Principal q = sorted(r.s1 + near * unit(random), r.s2 + near * unit(random), r.s3 + near * unit(random));
      if (yield(s, c, q) <= 0.0) CHECK(energy(t, q) >= found * (1.0 - 1e-9));
    }
  }
}

TEST_CASE("corner of the pyramid: isotropic tension returns to the apex c cot(phi)") {
  const MaterialConstants k = constants(30.0, 0.0, 0.3);
  const Principal r = return_mohr_coulomb(k, 1e4, {9e5, 8e5, 7e5});
  const double apex = 1e4 / std::tan(M_PI / 6.0);
  CHECK(r.s1 == doctest::Approx(apex));
  CHECK(r.s2 == doctest::Approx(apex));
  CHECK(r.s3 == doctest::Approx(apex));
}

TEST_CASE("Tresca's return keeps the mean stress and ends at twice the cohesion") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Material m;
  m.law = &law_named("tresca");
  m.youngs_modulus = 1e7;
  const MaterialConstants k = constants_of(m, 1.0);
  for (int i = 0; i < 100000; ++i) {
    const double c = 5e3;
    const Principal t = sorted(1e5 * unit(random), 1e5 * unit(random), 1e5 * unit(random));
    const Principal r = m.law->returned(k, c, t);
    CHECK(std::fabs(r.s1 + r.s2 + r.s3 - t.s1 - t.s2 - t.s3) < 1e-9 * 1e5);
    CHECK(r.s1 - r.s3 <= 2.0 * c * (1.0 + 1e-12) + 1e-9);
    CHECK(r.s1 >= r.s2 - 1e-9);
    CHECK(r.s2 >= r.s3 - 1e-9);
  }
}

TEST_CASE("the tension cut-off leaves no principal tension above it and no Mohr-Coulomb violation") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double c = 2.5e4, T = 1e3;
  MaterialConstants k = constants(35.0, 0.0, 0.3);
  k.tension = T;
  const Pyramid s(35.0);
  for (int i = 0; i < 100000; ++i) {
    const Principal t = sorted(2e5 * unit(random), 2e5 * unit(random), 2e5 * unit(random));
    const Principal r = return_mohr_coulomb(k, c, t);
    CHECK(r.s1 <= T * (1.0 + 1e-12));
    CHECK(yield(s, c, r) <= 1e-9 * c);
    CHECK(r.s2 >= r.s3 - 1e-9 * c);
  }
}

// mu(I): at rest Mohr-Coulomb, in flow Jop, Forterre & Pouliquen's friction, whatever the step.
#include <doctest/doctest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "mpm_stage/material/principal_stress.hpp"
#include "mpm_stage/material/stress_update.hpp"
#include "mpm_stage/scene/scene.hpp"

using namespace tailrun;
using namespace tailrun::mpm;

namespace {

constexpr double mu_s = 0.38, mu_2 = 0.64, I_0 = 0.279, diameter = 5e-4, grain = 2500.0;

Material read(const nlohmann::ordered_json& entry) {
  const auto path = std::filesystem::temp_directory_path() / ("tailrun_mu_i_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << nlohmann::ordered_json{{"materials", {{"soil", entry}}}}.dump();
  const CaseFile file(path);
  std::filesystem::remove(path);
  return read_material("soil", file.root().object("materials").object("soil"), 1.0);
}

MaterialConstants grains(double d = diameter) {
  return constants_of(read({{"model", "mu_i"},
                            {"youngs_modulus", 1e6},
                            {"poisson_ratio", 0.3},
                            {"mu_s", mu_s},
                            {"mu_2", mu_2},
                            {"grain_diameter", d},
                            {"grain_density", grain}}),
                      1.0);
}

MaterialConstants pyramid(double mu) {
  return constants_of(read({{"model", "mohr_coulomb"},
                            {"youngs_modulus", 1e6},
                            {"poisson_ratio", 0.3},
                            {"cohesion", 0},
                            {"friction_angle", std::asin(mu) * 180.0 / std::numbers::pi}}),
                      1.0);
}

template <int Dim>
Particles<Dim> particles(std::size_t n) {
  Particles<Dim> P;
  P.resize(n, true, true);
  for (std::size_t p = 0; p < n; ++p) P.mass[p] = P.volume[p] = 1.0;
  return P;
}

template <int Dim>
void set_stress(Particles<Dim>& P, std::size_t p, Principal s) {
  P.stress[0][p] = s.s1;
  P.stress[1][p] = s.s3;
  P.stress[2][p] = s.s2;
}

template <int Dim>
Principal principal(const Particles<Dim>& P, std::size_t p) {
  std::array<double, 3> s = {P.stress[0][p], P.stress[1][p], P.stress[2][p]};
  std::sort(s.begin(), s.end());
  return {s[2], s[1], s[0]};
}

Principal sorted(double a, double b, double c) {
  return {std::max({a, b, c}), std::max(std::min(a, b), std::min(std::max(a, b), c)), std::min({a, b, c})};
}

// What the return is to satisfy, of a trial t that ended at s: largest residual of mu = mu(I), 1; the stress must be in
// order. I is worked out anew from the plastic strain.
double residual(const MaterialConstants& k, double d, double dt, Principal t, Principal s) {
  const double p = -0.5 * (s.s1 + s.s3);
  if (p <= 0.0) return std::fabs(s.s1) + std::fabs(s.s2) + std::fabs(s.s3);
  const double mean = (t.s1 + t.s2 + t.s3 - s.s1 - s.s2 - s.s3) / 3.0;
  const double e1 = (t.s1 - s.s1 - mean) / (2.0 * k.mu), e2 = (t.s2 - s.s2 - mean) / (2.0 * k.mu),
               e3 = (t.s3 - s.s3 - mean) / (2.0 * k.mu);
  const double I = std::sqrt(2.0 * (e1 * e1 + e2 * e2 + e3 * e3)) / dt * d * std::sqrt(grain / p);
  return std::fabs(0.5 * (s.s1 - s.s3) / p - (mu_s + (mu_2 - mu_s) * I / (I + I_0)));
}

}  // namespace

TEST_CASE("mu_i: without rate it returns as Mohr-Coulomb with sin(phi) = mu_s does, a million trials") {
  const MaterialConstants k = grains(), m = pyramid(mu_s);
  const MaterialLaw &law = law_named("mu_i"), &rest = law_named("mohr_coulomb");
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double shift = 3.0 * unit(random), size = std::pow(10.0, 3.0 * unit(random));
    const Principal t =
        sorted(size * (unit(random) + shift), size * (unit(random) + shift), size * (unit(random) + shift));
    const Principal a = law.returned(k, 0.0, t), b = rest.returned(m, 0.0, t);
    worst = std::max(worst, (std::fabs(a.s1 - b.s1) + std::fabs(a.s2 - b.s2) + std::fabs(a.s3 - b.s3)) / size);
  }
  CHECK(worst < 1e-10);
}

TEST_CASE("mu_i: grains of no size flow as Mohr-Coulomb, particle by particle, in plane strain and in 3-D") {
  const MaterialConstants k = grains(1e-12), m = pyramid(mu_s);
  const auto compare = [&]<int Dim>() {
    Particles<Dim> P = particles<Dim>(3), Q = particles<Dim>(3);
    for (Particles<Dim>* one : {&P, &Q})
      for (std::size_t p = 0; p < 3; ++p)
        set_stress(*one, p, {-400.0, -420.0 - 250.0 * static_cast<double>(p), -1000.0});
    const std::array<double, 3> trace{-2e-6, -2e-6, -2e-6};
    for (int step = 0; step < 200; ++step) {
      for (Particles<Dim>* one : {&P, &Q})
        for (std::size_t p = 0; p < 3; ++p) {
          one->gradient[0][p] = -2e-6;
          one->gradient[1][p] = 1e-4;
          one->gradient[Dim + 1][p] = 0.0;
        }
      update_stress(k, P, 0, 3, trace.data(), 1e-3);
      update_stress(m, Q, 0, 3, trace.data(), 1e-3);
    }
    for (std::size_t p = 0; p < 3; ++p) {
      CHECK(Q.plastic_strain[p] > 5e-3);
      CHECK(P.plastic_strain[p] == doctest::Approx(Q.plastic_strain[p]).epsilon(1e-6));
      for (int c = 0; c < stress_components<Dim>; ++c)
        CHECK(P.stress[c][p] == doctest::Approx(Q.stress[c][p]).epsilon(1e-6).scale(1000.0));
    }
  };
  compare.operator()<2>();
  compare.operator()<3>();
}

TEST_CASE("mu_i: each return satisfies the law, in order, takes energy, for steps and grains of any size") {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0, least = 0.0, outside = 0.0, plane_and_solid = 0.0;
  long on_edges = 0, at_apex = 0;
  for (int round = 0; round < 20000; ++round) {
    const double d = std::pow(10.0, -4.0 + 2.0 * unit(random)), dt = std::pow(10.0, -4.0 + 4.0 * unit(random));
    const MaterialConstants k = grains(d);
    // Seven: four lanes and three at the end.
    Particles<2> P = particles<2>(7);
    Particles<3> Q = particles<3>(7);
    std::array<Principal, 7> trial;
    for (std::size_t p = 0; p < 7; ++p) {
      const double shift = -1.0 + 1.5 * unit(random), size = std::pow(10.0, 3.0 + 2.0 * unit(random));
      trial[p] = sorted(size * (unit(random) + shift), size * (unit(random) + shift), size * (unit(random) + shift));
      set_stress(P, p, trial[p]);
      set_stress(Q, p, trial[p]);
    }
    const std::array<double, 7> trace{};
    const double lost = update_stress(k, P, 0, 7, trace.data(), dt).dissipated;
    least = std::min(least, lost);
    update_stress(k, Q, 0, 7, trace.data(), dt);
    for (std::size_t p = 0; p < 7; ++p) {
      const Principal t = trial[p], s = principal(P, p), s3d = principal(Q, p);
      const double size = std::fabs(t.s1) + std::fabs(t.s3);
      plane_and_solid = std::max(
          plane_and_solid, (std::fabs(s.s1 - s3d.s1) + std::fabs(s.s2 - s3d.s2) + std::fabs(s.s3 - s3d.s3)) / size);
      outside = std::max(outside, (0.5 * (s.s1 - s.s3) + mu_2 * 0.5 * (s.s1 + s.s3)) / size);
      if (P.plastic_strain[p] == 0.0) continue;
      // Where s1 - s3 is round-off of the trial the ratio is not known.
      if (-(s.s1 + s.s3) < 1e-6 * size) {
        ++at_apex;
        continue;
      }
      on_edges += s.s1 - s.s2 < 1e-9 * size || s.s2 - s.s3 < 1e-9 * size;
      worst = std::max(worst, residual(k, d, dt, t, s));
    }
  }
  CHECK(worst < 1e-6);
  CHECK(least >= 0.0);
  CHECK(outside < 1e-12);
  CHECK(plane_and_solid < 1e-9);
  CHECK(on_edges > 1000);
  CHECK(at_apex > 1000);
}

TEST_CASE("mu_i: steady simple shear carries mu(I) times its pressure, for steps that differ a hundred times") {
  for (const double I : {1e-3, 0.05, 0.279, 3.0}) {
    const double p = 100.0, rate = I / (diameter * std::sqrt(grain / p));
    double wanted = mu_s + (mu_2 - mu_s) * I / (I + I_0);
    for (const double dt : {1e-6, 1e-5, 1e-4}) {
      const MaterialConstants k = grains();
      Particles<2> P = particles<2>(1);
      set_stress(P, 0, {-p, -p, -p});
      const double none = 0.0;
      for (double strain = 0.0; strain < 0.02; strain += rate * dt) {
        P.gradient[1][0] = rate * dt;
        update_stress(k, P, 0, 1, &none, dt);
      }
      CAPTURE(I);
      CAPTURE(dt);
      CHECK(P.stress[3][0] / -P.stress[1][0] == doctest::Approx(wanted).epsilon(2e-3));
    }
  }
}

TEST_CASE("mu_i: keys out of their range are refused") {
  const nlohmann::ordered_json good = {{"model", "mu_i"}, {"youngs_modulus", 1e6}, {"poisson_ratio", 0.3},
                                       {"mu_s", 0.3},     {"mu_2", 0.6},           {"grain_diameter", 1e-3}};
  CHECK_NOTHROW(read(good));
  for (const auto& [key, value] : std::vector<std::pair<const char*, double>>{{"mu_s", 0.0},
                                                                              {"mu_s", 1.0},
                                                                              {"mu_2", 0.29},
                                                                              {"mu_2", 1.0},
                                                                              {"I_0", 0.0},
                                                                              {"grain_diameter", 0.0},
                                                                              {"grain_diameter", -1.0},
                                                                              {"grain_density", 0.0}}) {
    auto bad = good;
    bad[key] = value;
    CHECK_THROWS_WITH_AS(read(bad), doctest::Contains(key), InputError);
  }
}

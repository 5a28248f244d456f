// Mohr-Coulomb return in plane strain.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "fem_stage/material/mohr_coulomb.hpp"

using namespace tailrun::fem;

namespace {

MohrCoulombLaw soil(double c, double phi, double psi, double cutoff) {
  MohrCoulombParameters p;
  p.shear_modulus = 50e6;
  p.poisson = 0.3;
  p.cohesion = c;
  p.friction_angle = phi;
  p.dilation_angle = psi;
  p.tension_cutoff = cutoff;
  p.density = 1700.0;
  return resolve(p);
}

std::array<double, 3> principal(const PlaneStrainStress& s) {
  const double centre = 0.5 * (s.xx + s.yy), radius = std::hypot(0.5 * (s.xx - s.yy), s.xy);
  std::array<double, 3> out{centre + radius, centre - radius, s.zz};
  std::sort(out.rbegin(), out.rend());
  return out;
}

}  // namespace

TEST_CASE("Mohr-Coulomb: inside the surface the trial stress stands, bit for bit") {
  const MohrCoulombReturn r = return_to_yield(soil(25e3, 35.0, 0.0, 0.0), 50e6, 0.3, {-100e3, -80e3, -60e3, 10e3});
  CHECK(r.planes == 0);
  CHECK(r.stress.xx == -100e3);
  CHECK(r.stress.xy == 10e3);
}

TEST_CASE("Mohr-Coulomb: uniaxial compressive strength 2 c cos(phi)/(1 - sin(phi))") {
  const MohrCoulombLaw law = soil(25e3, 35.0, 0.0, 0.0);
  PlaneStrainStress s{0.0, 0.0, 0.0, 0.0};
  // Drained compression in y with zero lateral stress in x: the plane (xx, yy) fails first.
  for (int i = 0; i < 4000; ++i) {
    PlaneStrainStress trial = elastic_stress(s, 50e6, 0.3, 0.0, -1e-6, 0.0);
    trial.xx = 0.0;
    s = return_to_yield(law, 50e6, 0.3, trial).stress;
    s.xx = 0.0;
  }
  const double phi = 35.0 * M_PI / 180.0;
  CHECK(-s.yy == doctest::Approx(2.0 * 25e3 * std::cos(phi) / (1.0 - std::sin(phi))).epsilon(1e-2));
}

TEST_CASE("Mohr-Coulomb: phi = 0 keeps the mean stress and limits the shear to c") {
  const MohrCoulombReturn r = return_to_yield(soil(10e3, 0.0, 0.0, 1e9), 50e6, 0.3, {-100e3, -100e3, -100e3, 40e3});
  CHECK(r.stress.xy == doctest::Approx(10e3));
  CHECK(r.stress.xx == doctest::Approx(-100e3));
  CHECK(r.plastic_volume == doctest::Approx(0.0));
  CHECK(r.plastic_strain == doctest::Approx((40e3 - 10e3) / 50e6 / std::sqrt(3.0)).epsilon(1e-9));
}

TEST_CASE("Mohr-Coulomb: associated flow on the plane dilates by sin(psi)") {
  const MohrCoulombReturn r = return_to_yield(soil(0.0, 30.0, 20.0, 0.0), 50e6, 0.3, {-100e3, -100e3, -95e3, 60e3});
  REQUIRE(r.planes == 1);
  // The plastic strains of the plane are (k_psi, -1): volume over shear is sin(psi).
  const double k = (1 + std::sin(20 * M_PI / 180)) / (1 - std::sin(20 * M_PI / 180));
  CHECK((k - 1.0) / (k + 1.0) == doctest::Approx(std::sin(20 * M_PI / 180)));
  const double shear = r.plastic_volume / std::sin(20 * M_PI / 180);  // of the principal plastic strain difference
  const double volume = r.plastic_volume, a = 0.5 * (volume + shear), b = 0.5 * (volume - shear);
  const double m = volume / 3.0;
  CHECK(r.plastic_strain ==
        doctest::Approx(std::sqrt(2.0 / 3.0 * ((a - m) * (a - m) + (b - m) * (b - m) + m * m))).epsilon(1e-9));
}

TEST_CASE("Mohr-Coulomb: pure tension ends at the cut-off") {
  const MohrCoulombReturn r = return_to_yield(soil(25e3, 35.0, 0.0, 5e3), 50e6, 0.3, {200e3, 200e3, 200e3, 1e3});
  CHECK(r.planes == 3);
  CHECK(r.stress.xx == doctest::Approx(5e3));
  CHECK(r.stress.yy == doctest::Approx(5e3));
  CHECK(r.stress.zz == doctest::Approx(5e3));
  CHECK(std::fabs(r.stress.xy) < 1e-6);
}

TEST_CASE("Mohr-Coulomb: a million random trial stresses all come back to the surface") {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double worst = 0.0;
  for (int set = 0; set < 1000; ++set) {
    const double c = 50e3 * uniform(generator) + 100.0, phi = 50.0 * uniform(generator);
    const MohrCoulombLaw law = soil(c, phi, phi * uniform(generator), 2.0 * c * uniform(generator));
    for (int i = 0; i < 1000; ++i) {
      const double size = std::pow(10.0, 3.0 + 4.0 * uniform(generator));
      const PlaneStrainStress trial{size * normal(generator), size * normal(generator), size * normal(generator),
                                    size * normal(generator)};
      const MohrCoulombReturn r = return_to_yield(law, 50e6, 0.3, trial);
      const double scale = size + law.strength;
      worst = std::max(worst, yield_excess(law, r.stress) / scale);
      REQUIRE(std::isfinite(r.stress.xx + r.stress.yy + r.stress.zz + r.stress.xy + r.plastic_strain));
    }
  }
  CHECK(worst < 1e-10);
}

// An independent check of which plane, edge or corner: associated flow is the closest point in the energy norm, so no
// admissible stress found by a search may be closer to the trial stress.
TEST_CASE("Mohr-Coulomb: associated return is the closest admissible stress in the elastic energy") {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  MohrCoulombLaw law = soil(20e3, 30.0, 30.0, 15e3);
  const double G = 50e6, nu = 0.3, E = 2.0 * G * (1.0 + nu);
  const auto energy = [&](const std::array<double, 3>& d) {
    return (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 2.0 * nu * (d[0] * d[1] + d[1] * d[2] + d[2] * d[0])) / E;
  };
  for (int i = 0; i < 300; ++i) {
    const PlaneStrainStress trial{6e4 * normal(generator), 6e4 * normal(generator), 6e4 * normal(generator), 0.0};
    const MohrCoulombReturn r = return_to_yield(law, G, nu, trial);
    if (r.planes == 0) continue;
    const auto closest = energy({trial.xx - r.stress.xx, trial.yy - r.stress.yy, trial.zz - r.stress.zz});
    for (int k = 0; k < 500; ++k) {
      const double reach = 3e4 * std::pow(10.0, -4.0 * (k % 10) / 10.0);
      const PlaneStrainStress other{r.stress.xx + reach * normal(generator), r.stress.yy + reach * normal(generator),
                                    r.stress.zz + reach * normal(generator), 0.0};
      if (yield_excess(law, other) > 0.0) continue;
      CHECK(energy({trial.xx - other.xx, trial.yy - other.yy, trial.zz - other.zz}) >= closest * (1.0 - 1e-9));
    }
  }
}

TEST_CASE("Mohr-Coulomb: the return turns with the axes") {
  const MohrCoulombLaw law = soil(5e3, 34.0, 5.0, 0.0);
  const PlaneStrainStress trial{-20e3, -150e3, -40e3, 30e3}, turned{-150e3, -20e3, -40e3, -30e3};
  const MohrCoulombReturn a = return_to_yield(law, 50e6, 0.3, trial), b = return_to_yield(law, 50e6, 0.3, turned);
  CHECK(a.stress.xx == doctest::Approx(b.stress.yy));
  CHECK(a.stress.xy == doctest::Approx(-b.stress.xy));
  CHECK(principal(a.stress)[0] == doctest::Approx(principal(b.stress)[0]));
}

#include <doctest/doctest.h>

#include "material_drive.hpp"

using namespace tailrun::fem;
using namespace tailrun::fem::testing;

namespace {

struct Expected {
  double xi, M_b, M_d, A_do, z_max, h0, C_DR, C_Kaf, C_eps, F_sed_min;
};

void check(const Pm4SandParameters& parameters, const Expected& e) {
  const auto point = drive(parameters, 50.65e3, 101.3e3);  // p0 = 75.975 kPa
  const Pm4Surfaces s = point.law.surfaces(point.constants, 75.975e3, point.law.index0);
  CHECK(s.xi == doctest::Approx(e.xi).epsilon(1e-4));
  CHECK(s.M_b == doctest::Approx(e.M_b).epsilon(1e-5));
  CHECK(s.M_d == doctest::Approx(e.M_d).epsilon(1e-5));
  CHECK(point.constants.A_do == doctest::Approx(e.A_do).epsilon(1e-5));
  CHECK(point.constants.z_max == doctest::Approx(e.z_max).epsilon(1e-5));
  CHECK(point.law.h0 == doctest::Approx(e.h0));
  CHECK(point.law.C_DR == doctest::Approx(e.C_DR));
  CHECK(point.law.C_Kaf == doctest::Approx(e.C_Kaf).epsilon(1e-5));
  CHECK(point.constants.C_eps_squared == doctest::Approx(e.C_eps * e.C_eps));
  CHECK(point.law.F_sed_min == doctest::Approx(e.F_sed_min).epsilon(1e-5));
}

}  // namespace

// Constants at sigma'_v = 1 atm, K0 = 0.5, from the formulas of UCD/CGM-17/01 as OpenSees evaluates them.
TEST_CASE("PM4Sand: constants at initialisation, medium dense and dense") {
  check(loose(), {-0.08603, 1.13716, 1.07995, 1.25931, 1.18308, 0.300, 5.0, 5.16038, 0.5, 0.074530});
  check(embankment(), {-0.28603, 1.25675, 1.05856, 1.30564, 4.00732, 0.400, 10.0, 10.36558, 0.5, 0.125361});
  check(foundation(), {-0.48603, 1.38893, 1.03760, 1.36423, 13.57353, 0.500, 10.0, 30.88278, 0.2, 0.210861});
}

TEST_CASE("PM4Sand: constants at initialisation, loose of critical") {
  check(tailings(), {0.13825, 1.07062, 1.15121, 1.24, 0.30120, 0.300, 5.0, 5.16038, 0.5, 0.074530});
}

TEST_CASE("PM4Sand: shear modulus coefficient follows (N1)60 = 46 D_R^2 when it is not given") {
  Pm4SandParameters p = loose();
  p.shear_coefficient = unset;
  CHECK(resolve(p).G0_pA == doctest::Approx(476.0 * 101.3e3).epsilon(1e-3));
}

TEST_CASE("PM4Sand: a stress that it cannot carry is handed through as a constant offset") {
  auto tension = drive(embankment(), -20e3, 3e3, 4e3);
  CHECK(tension.state.v.p == doctest::Approx(tension.constants.p_min));
  PlaneStress total = total_stress(tension.constants, tension.state);
  CHECK(total.p == doctest::Approx(-8.5e3));
  CHECK(total.s.d == doctest::Approx(-11.5e3));
  CHECK(total.s.xy == doctest::Approx(4e3));
  // Beyond both surfaces: cut back to the larger one, the rest is offset.
  auto steep = drive(embankment(), 10e3, 100e3, 30e3);
  const Pm4Surfaces s = steep.law.surfaces(steep.constants, 55e3, steep.law.index0);
  CHECK(sqrt_two * norm(steep.state.v.s) / steep.state.v.p == doctest::Approx(std::max(s.M_b, s.M_d)));
  total = total_stress(steep.constants, steep.state);
  CHECK(total.s.xy == doctest::Approx(30e3));
}

TEST_CASE("PM4Sand: undrained critical state s = M/2 (p_A/100) exp(Q - R/D_R)") {
  // Relative state parameter zero at p_cs = 3.657 kPa for the tailings, 307 kPa for the default loose sand.
  const auto point = drive(tailings(), 50e3, 100e3);
  CHECK(point.law.surfaces(point.constants, 3.657e3, 0.35).xi == doctest::Approx(0.0).epsilon(1e-3));
  CHECK(0.5 * point.law.M * 3.657e3 == doctest::Approx(1992.0).epsilon(1e-3));
  const auto sand_point = drive(loose(), 50e3, 100e3);
  CHECK(std::fabs(sand_point.law.surfaces(sand_point.constants, 307.3e3, 0.35).xi) < 1e-3);
}

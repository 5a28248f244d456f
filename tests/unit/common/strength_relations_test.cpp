#include "common/residual_strength/relations.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun;

namespace {

// Comparison table of the correlations, kPa: printed with two decimals, so each entry is within 0.5 % or 0.005 of it.
struct Row {
  double n, stress, weber_50, weber_33, weber_16, weber_84, kramer_wang, deviation, with_redistribution, without,
      olson_stark;
};

constexpr Row table[] = {
    {2, 17, 1.94, 1.02, -0.16, 4.04, 2.44, 0.388, 0.72, 0.72, 0.77},
    {2, 50, 3.12, 2.19, 1.02, 5.22, 4.07, 0.363, 2.11, 2.12, 2.25},
    {2, 100, 4.37, 3.44, 2.25, 6.49, 5.84, 0.369, 4.23, 4.24, 4.50},
    {2, 186, 6.07, 5.10, 3.88, 8.25, 8.23, 0.393, 7.87, 7.89, 8.37},
    {6, 17, 3.41, 2.26, 0.80, 6.03, 3.77, 0.361, 1.11, 1.13, 1.27},
    {6, 50, 5.48, 4.32, 2.85, 8.10, 6.30, 0.346, 3.26, 3.32, 3.75},
    {6, 100, 7.68, 6.50, 5.01, 10.35, 9.03, 0.360, 6.52, 6.63, 7.50},
    {6, 186, 10.65, 9.39, 7.78, 13.52, 12.73, 0.390, 12.13, 12.33, 13.95},
    {10, 17, 5.99, 4.53, 2.67, 9.31, 5.84, 0.366, 1.55, 1.68, 1.78},
    {10, 50, 9.61, 8.15, 6.28, 12.95, 9.74, 0.361, 4.55, 4.95, 5.25},
    {10, 100, 13.48, 11.98, 10.07, 16.89, 13.96, 0.382, 9.09, 9.89, 10.50},
    {10, 186, 18.70, 17.05, 14.95, 22.45, 19.69, 0.416, 16.91, 18.40, 19.53},
};

void check(double found_pa, double expected_kpa) {
  CHECK(std::abs(found_pa / 1e3 - expected_kpa) <= std::max(0.005 * std::abs(expected_kpa), 0.0051));
}

}  // namespace

TEST_CASE("the correlations reproduce their comparison table") {
  for (const Row& row : table) {
    CAPTURE(row.n);
    CAPTURE(row.stress);
    const double sigma = 1e3 * row.stress;
    check(weber_2015(row.n, sigma), row.weber_50);
    check(weber_2015(row.n, sigma, standard_normal_quantile(0.33)), row.weber_33);
    check(weber_2015(row.n, sigma, -1.0), row.weber_16);
    check(weber_2015(row.n, sigma, 1.0), row.weber_84);
    check(kramer_wang_2015(row.n, sigma), row.kramer_wang);
    CHECK(kramer_wang_2015_deviation(row.n, sigma) == doctest::Approx(row.deviation).epsilon(0.005));
    check(idriss_boulanger_spt_ratio(row.n, true) * sigma, row.with_redistribution);
    check(idriss_boulanger_spt_ratio(row.n, false) * sigma, row.without);
    check(olson_stark_spt_ratio(row.n) * sigma, row.olson_stark);
  }
}

TEST_CASE("the fit to the paper goes through both of its points") {
  CHECK(seed_fit(6.0, 17e3) == doctest::Approx(3200.0).epsilon(1e-4));
  CHECK(seed_fit(6.0, 186e3) == doctest::Approx(9100.0).epsilon(1e-4));
  CHECK(seed_fit(6.0, 50e3) == doctest::Approx(4940.0).epsilon(1e-3));
  CHECK(seed_fit(6.0, 100e3) == doctest::Approx(6740.0).epsilon(1e-3));
}

TEST_CASE("Idriss and Boulanger's ratios at their tabulated blow counts and cone resistances") {
  const double n[] = {0, 4, 8, 12, 16}, with[] = {0.0324, 0.0533, 0.0778, 0.1047, 0.1353};
  const double without[] = {0.0324, 0.0537, 0.0808, 0.1258, 0.2800};
  for (int i = 0; i < 5; ++i) {
    CHECK(idriss_boulanger_spt_ratio(n[i], true) == doctest::Approx(with[i]).epsilon(0.002));
    CHECK(idriss_boulanger_spt_ratio(n[i], false) == doctest::Approx(without[i]).epsilon(0.002));
  }
  const double q[] = {40, 80, 100}, cone_with[] = {0.0427, 0.0902, 0.1194}, cone_without[] = {0.0428, 0.0968, 0.1724};
  for (int i = 0; i < 3; ++i) {
    CHECK(idriss_boulanger_cpt_ratio(q[i], true) == doctest::Approx(cone_with[i]).epsilon(0.002));
    CHECK(idriss_boulanger_cpt_ratio(q[i], false) == doctest::Approx(cone_without[i]).epsilon(0.002));
  }
  CHECK(fines_increment_spt(50.0) == 4.0);
  CHECK(fines_increment_spt(37.5) == doctest::Approx(3.0));
  CHECK(fines_increment_cpt(90.0) == 55.0);
}

TEST_CASE("Robertson's ratios, and Olson and Stark's by cone") {
  const double q[] = {40, 60, 70}, expected[] = {0.044, 0.090, 0.26};
  for (int i = 0; i < 3; ++i) CHECK(robertson_2010_ratio(q[i]) == doctest::Approx(expected[i]).epsilon(0.02));
  CHECK(robertson_2010_ratio(20.0) == 0.03);  // the formula's 0.029 is raised to the bound
  CHECK(robertson_2022_ratio(10.0) == 0.02);
  CHECK(robertson_2022_ratio(50.0) == doctest::Approx(0.0007 * std::exp(4.2) + 0.006).epsilon(1e-14));
  CHECK(olson_stark_cpt_ratio(3e6) == doctest::Approx(0.0729).epsilon(1e-12));
  CHECK(olson_stark_spt_ratio(6.0, 1.0) == doctest::Approx(0.105).epsilon(1e-12));
}

TEST_CASE("quantiles of the standard normal distribution") {
  CHECK(standard_normal_quantile(0.5) == 0.0);
  CHECK(standard_normal_quantile(0.33) == doctest::Approx(-0.4399131656732338).epsilon(1e-12));
  CHECK(standard_normal_quantile(0.975) == doctest::Approx(1.959963984540054).epsilon(1e-12));
  CHECK(standard_normal_quantile(1e-9) == doctest::Approx(-5.997807015007774).epsilon(1e-9));
}

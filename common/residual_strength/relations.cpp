#include "common/residual_strength/relations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace tailrun {
namespace {

constexpr double atmospheric = 101325.0;  // Pa
constexpr double psf = 47.8803;           // Pa
constexpr double deviation_olson_stark = 0.03;

using Table = std::array<std::pair<double, double>, 5>;

double interpolate_table(const Table& table, double x) {
  if (x <= table.front().first) return table.front().second;
  for (std::size_t i = 1; i < table.size(); ++i)
    if (x <= table[i].first) {
      const auto& [x0, y0] = table[i - 1];
      const auto& [x1, y1] = table[i];
      return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
    }
  return table.back().second;
}

}  // namespace

double standard_normal_quantile(double probability) {
  // Newton's method on Phi(z) = erfc(-z/sqrt 2)/2 in the lower half, where it converges from above; symmetry does the
  // rest.
  if (probability > 0.5) return -standard_normal_quantile(1.0 - probability);
  double z = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double cumulated = 0.5 * std::erfc(-z / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    const double step = std::clamp((cumulated - probability) / density, -0.5, 0.5);
    z -= step;
    if (std::abs(step) < 1e-15 * (1.0 + std::abs(z))) break;
  }
  return z;
}

double weber_2015(double n60cs, double sigma_v0, double z) {
  const double x = sigma_v0 / atmospheric;
  const double median = std::exp(0.1407 * n60cs + 4.2399 * std::pow(x, 0.120));
  const double deviation = std::pow(n60cs, 1.45) + 0.2 * n60cs * std::pow(x, 2.48) + 41.13;
  return psf * (median + z * deviation);
}

double seed_fit(double n60cs, double sigma_v0) {
  return 1e3 * std::exp(-2.8237 + 0.1407 * n60cs + 3.8934 * std::pow(sigma_v0 / atmospheric, 0.12));
}

double kramer_wang_2015_deviation(double n60, double sigma_v0) {
  const double x = std::pow(sigma_v0 / atmospheric, 0.1);
  return std::sqrt(1.627 + 0.00073 * n60 * n60 + 0.0194 * n60 * x - 0.027 * n60 - 3.099 * x + 1.621 * x * x);
}

double kramer_wang_2015(double n60, double sigma_v0, double z) {
  const double median = atmospheric * std::exp(-8.444 + 0.109 * n60 + 5.379 * std::pow(sigma_v0 / atmospheric, 0.1));
  return z == 0.0 ? median : median * std::exp(z * kramer_wang_2015_deviation(n60, sigma_v0));
}

double idriss_boulanger_spt_ratio(double n, bool void_redistribution) {
  const double ratio = std::exp(n / 16.0 + std::pow((n - 16.0) / 21.2, 3) - 3.0);
  return void_redistribution ? ratio : ratio * (1.0 + std::exp(n / 2.4 - 6.6));
}

double idriss_boulanger_cpt_ratio(double q, bool void_redistribution) {
  const double ratio = std::exp(q / 24.5 - std::pow(q / 61.7, 2) + std::pow(q / 106.0, 3) - 4.42);
  return void_redistribution ? ratio : ratio * (1.0 + std::exp(q / 11.1 - 9.82));
}

double fines_increment_spt(double fines_content) {
  static constexpr Table table = {{{0.0, 0.0}, {10.0, 1.0}, {25.0, 2.0}, {50.0, 4.0}, {75.0, 5.0}}};
  return interpolate_table(table, fines_content);
}

double fines_increment_cpt(double fines_content) {
  static constexpr Table table = {{{0.0, 0.0}, {10.0, 10.0}, {25.0, 25.0}, {50.0, 45.0}, {75.0, 55.0}}};
  return interpolate_table(table, fines_content);
}

double olson_stark_spt_ratio(double n60, double z) {
  return 0.03 + 0.0075 * n60 + z * deviation_olson_stark;
}

double olson_stark_cpt_ratio(double q_c1, double z) {
  return 0.03 + 0.0143 * q_c1 / 1e6 + z * deviation_olson_stark;
}

double robertson_2010_ratio(double q) {
  return std::max(0.03, (0.02199 - 0.0003124 * q) / (1.0 - 0.02676 * q + 0.0001783 * q * q));
}

double robertson_2022_ratio(double q) {
  return q < 20.0 ? 0.02 : 0.0007 * std::exp(0.084 * q) + 0.3 / q;
}

}  // namespace tailrun

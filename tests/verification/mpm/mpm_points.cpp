// Rows of the verification table that are about one point or about quantities no file holds, linked to mpm_stage's own
// code: verify_mpm_points mohr_coulomb_point | spinning_square. Prints a JSON list of {quantity, error, ceiling}.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>

#include "mpm_stage/material/principal_stress.hpp"
#include "mpm_stage/material/stress_update.hpp"
#include "mpm_stage/step/solver.hpp"

using namespace tailrun::mpm;
using Rows = nlohmann::json;

namespace {

using Stress = std::array<double, 3>;  // principal, Pa

void add(Rows& rows, const std::string& quantity, double error, double ceiling) {
  rows.push_back({{"quantity", quantity}, {"error", error}, {"ceiling", ceiling}});
}

MaterialConstants constants(double phi, double psi, double nu) {
  Material m;
  m.law = &law_named("mohr_coulomb");
  m.youngs_modulus = 1e7;
  m.poisson_ratio = nu;
  m.friction_angle = phi;
  m.dilation_angle = psi;
  return constants_of(m, 1.0);
}

// (1 + sin a) / (1 - sin a) of an angle in degrees.
double ratio(double angle) {
  const double s = std::sin(angle * std::numbers::pi / 180.0);
  return (1.0 + s) / (1.0 - s);
}

Stress sorted(Stress s) {
  std::sort(s.begin(), s.end(), std::greater<>());
  return s;
}

// Koiter's rule with multipliers found by bisection, in the way of a textbook and slow: first the plane (1, 3) alone,
// then with the plane beside it that is violated, then the apex.
class BisectionReturn {
 public:
  // `slope` is the yield plane's, `potential` the flow potential's, 1.
  BisectionReturn(const MaterialConstants& k, double c, double slope, double potential)
      : k_(k), slope_(slope), potential_(potential), strength_(c) {}

  Stress operator()(const Stress& t) const {
    const double span = (t[0] - t[2] + std::fabs(t[0]) + strength_) / k_.mu * 4.0;
    const double single = root([&](double a) { return yield(0, 2, minus(t, 0, 2, a)); }, span);
    const Stress s = minus(t, 0, 2, single);
    const bool upper = s[1] > s[0], lower = s[1] < s[2];
    if (!upper && !lower) return s;
    const int i = upper ? 1 : 0, j = upper ? 2 : 1;
    const auto inner = [&](double b) {
      const Stress moved = minus(t, i, j, b);
      return root([&](double a) { return yield(0, 2, minus(moved, 0, 2, a)); }, span);
    };
    const double both = root(
        [&](double b) {
          const Stress moved = minus(t, i, j, b);
          return yield(i, j, minus(moved, 0, 2, inner(b)));
        },
        span);
    const Stress e = minus(minus(t, i, j, both), 0, 2, inner(both));
    // Beyond the end of the edge the order of the principal stresses is turned round: the apex.
    if (e[0] < e[2]) {
      const double apex = strength_ / (slope_ - 1.0);
      return {apex, apex, apex};
    }
    return e;
  }

 private:
  double yield(int i, int j, const Stress& s) const { return slope_ * s[i] - s[j] - strength_; }
  // t - a D b for the potential m s_i - s_j.
  Stress minus(const Stress& t, int i, int j, double a) const {
    Stress s;
    for (int q = 0; q < 3; ++q)
      s[q] = t[q] - a * (k_.lambda * (potential_ - 1.0) + 2.0 * k_.mu * ((q == i) * potential_ - (q == j) * 1.0));
    return s;
  }
  // Where the falling function f crosses zero in [0, high]; 0 when it starts below.
  template <class Function>
  static double root(const Function& f, double high) {
    double low = 0.0;
    if (f(low) <= 0.0) return 0.0;
    for (int n = 0; n < 60; ++n) {
      const double middle = 0.5 * (low + high);
      (f(middle) > 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  const MaterialConstants& k_;
  double slope_, potential_, strength_;
};

Rows mohr_coulomb_point() {
  std::mt19937 random(2026);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double c = 1e4;
  const MaterialLaw& law = law_named("mohr_coulomb");
  double residual = 0.0, unordered = 0.0, apart = 0.0, failed = 0.0;
  long returns[3] = {0, 0, 0};  // plane, edges, apex
  for (const double phi : {5.0, 19.8, 35.0, 50.0})
    for (const double share : {0.0, 0.3}) {
      const MaterialConstants k = constants(phi, share * phi, 0.3);
      const double slope = ratio(phi), strength = 2.0 * std::sqrt(slope) * c;
      const BisectionReturn reference(k, strength, slope, ratio(share * phi));
      for (int n = 0; n < 125000; ++n) {
        const double size = std::pow(10.0, 4.5 + unit(random));
        const Stress t = sorted({size * unit(random), size * unit(random), size * unit(random)});
        const Principal r = law.returned(k, c, {t[0], t[1], t[2]});
        residual = std::max(residual, (slope * r.s1 - r.s3 - strength) / c);
        unordered = std::max({unordered, (r.s2 - r.s1) / c, (r.s3 - r.s2) / c});
        failed += !std::isfinite(r.s1 + r.s2 + r.s3);
        if (n >= 2500 || slope * t[0] - t[2] <= strength) continue;
        const Stress b = reference(t);
        apart = std::max({apart, std::fabs(r.s1 - b[0]), std::fabs(r.s2 - b[1]), std::fabs(r.s3 - b[2])});
        ++returns[std::fabs(r.s1 - r.s3) < 1e-9 * c ? 2 : std::min(r.s1 - r.s2, r.s2 - r.s3) < 1e-9 * c ? 1 : 0];
      }
    }
  for (const long n : returns)
    if (n == 0) failed += 1.0;
  Rows rows = Rows::array();
  add(rows, "yield residual over c, 1e6 random trials", std::max(residual, 0.0), 1e-10);
  add(rows, "returned stresses out of order, over c", std::max(unordered, 0.0), 1e-10);
  add(rows, "failed returns, or a kind of return that no trial met", failed, 0.0);
  add(rows,
      fmt::format("difference from bisection over c ({} planes, {} edges, {} apices)", returns[0], returns[1],
                  returns[2]),
      apart / c, 1e-8);
  return rows;
}

// Linear and angular momentum; the affine velocity's spin counts with D = h^2 / 4 (Jiang et al. 2015, eq. 6).
std::array<double, 3> momenta(const Particles<2>& P, double h) {
  std::array<double, 3> sum{};
  for (std::size_t p = 0; p < P.count(); ++p) {
    const double m = P.mass[p];
    sum[0] += m * P.velocity[0][p];
    sum[1] += m * P.velocity[1][p];
    sum[2] += m * (P.position[0][p] * P.velocity[1][p] - P.position[1][p] * P.velocity[0][p] +
                   0.25 * h * h * (P.affine[2][p] - P.affine[1][p]));
  }
  return sum;
}

// Largest change of the angular momentum over its size in two turns of a square of 8 x 8 cells, and of the linear one
// over the speed of its corners.
std::array<double, 2> spin(TransferName transfer) {
  const double h = 0.25, omega = 0.5;
  const int n = 16;
  Particles<2> P;
  P.resize(n * n, true, false);
  for (int p = 0; p < n * n; ++p) {
    const double x = (p % n + 0.5 - n / 2) * 0.5 * h, y = (p / n + 0.5 - n / 2) * 0.5 * h;
    P.position[0][p] = x;
    P.position[1][p] = y;
    P.velocity[0][p] = 0.5 - omega * y;
    P.velocity[1][p] = 0.25 + omega * x;
    P.affine[1][p] = -omega;
    P.affine[2][p] = omega;
    P.volume[p] = 0.25 * h * h;
    P.mass[p] = 2000.0 * P.volume[p];
    P.identity[p] = p;
  }
  Material m;
  m.name = "solid";
  m.law = &law_named("linear_elastic");
  m.youngs_modulus = 2e6;
  m.poisson_ratio = 0.3;
  SolverOptions o;
  o.transfer = transfer;
  const Terrain none;
  const auto solver = make_solver<2>(o, h, {}, std::move(P), {m}, none, Walls<2>{});
  solver->start(1e30);
  const auto before = momenta(solver->particles(), h);
  const double mass = 2000.0 * 4.0;
  std::array<double, 2> most{};
  for (double time = 0.0; time < 8.0 * M_PI; time += solver->step({0, 0}, {0, 0}, 1e30).dt) {
    const auto now = momenta(solver->particles(), h);
    most[0] = std::max(most[0], std::fabs(now[2] / before[2] - 1.0));
    for (int d = 0; d < 2; ++d) most[1] = std::max(most[1], std::fabs(now[d] - before[d]) / (mass * omega));
  }
  return most;
}

// A stressed point turned ten times round by rigid steps of 0.02 rad: error of its stress over its size.
double rigid_turns() {
  Material m;
  m.law = &law_named("linear_elastic");
  m.youngs_modulus = 1e9;
  m.poisson_ratio = 0.3;
  const MaterialConstants k = constants_of(m, 1.0);
  Particles<2> P;
  P.resize(1, false, false);
  P.volume[0] = P.mass[0] = 1.0;
  const double stress[4] = {-3e5, -1e5, -2e5, 4e4};
  for (int c = 0; c < 4; ++c) P.stress[c][0] = stress[c];
  const double half = std::tan(0.01), none = 0.0;  // midpoint gradient of a turn by 0.02: 2 tan(0.01) times the spin
  double angle = 0.0;
  for (int n = 0; n < 3142; ++n, angle += 0.02) {
    P.gradient[0][0] = P.gradient[3][0] = 0.0;
    P.gradient[1][0] = -2.0 * half;
    P.gradient[2][0] = 2.0 * half;
    update_stress(k, P, 0, 1, &none, 1e-3);
  }
  const double c = std::cos(angle), s = std::sin(angle);
  const double exact[4] = {c * c * stress[0] - 2.0 * c * s * stress[3] + s * s * stress[1],
                           s * s * stress[0] + 2.0 * c * s * stress[3] + c * c * stress[1], stress[2],
                           c * s * (stress[0] - stress[1]) + (c * c - s * s) * stress[3]};
  double error = 0.0;
  for (int i = 0; i < 4; ++i) error = std::max(error, std::fabs(P.stress[i][0] - exact[i]) / 3e5);
  return error;
}

Rows spinning_square() {
  Rows rows = Rows::array();
  const auto apic = spin(TransferName::apic), aflip = spin(TransferName::aflip);
  add(rows, "change of angular momentum over two turns, APIC", apic[0], 1e-12);
  add(rows, "change of angular momentum over two turns, default transfer", aflip[0], 1e-12);
  add(rows, "change of linear momentum over m R omega, default transfer", aflip[1], 1e-12);
  add(rows, "stress after 10 rigid turns over its size", rigid_turns(), 1e-10);
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc == 2 ? argv[1] : "";
  if (name != "mohr_coulomb_point" && name != "spinning_square") {
    fmt::print(stderr, "usage: verify_mpm_points mohr_coulomb_point | spinning_square\n");
    return 1;
  }
  fmt::print("{}\n", (name == "mohr_coulomb_point" ? mohr_coulomb_point() : spinning_square()).dump(1));
  return 0;
}

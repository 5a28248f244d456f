#include "fem_stage/material/mohr_coulomb.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace tailrun::fem {

namespace {

using Principal = std::array<double, 3>;  // s_1 >= s_2 >= s_3

// A plane k s_i - l s_j <= strength of the surface and the direction (k_flow, -l) in which it flows.
struct Plane {
  int i;
  int j;
  double k;
  double l;
  double k_flow;
  double strength;
};

enum PlaneName { shear_13, shear_12, shear_23, tension_1, tension_2, tension_3, plane_count };

std::array<Plane, plane_count> planes_of(const MohrCoulombLaw& law) {
  return {{{0, 2, law.k, 1.0, law.k_psi, law.strength},
           {0, 1, law.k, 1.0, law.k_psi, law.strength},
           {1, 2, law.k, 1.0, law.k_psi, law.strength},
           {0, 1, 1.0, 0.0, 1.0, law.cutoff},
           {1, 2, 1.0, 0.0, 1.0, law.cutoff},
           {2, 0, 1.0, 0.0, 1.0, law.cutoff}}};
}

double value(const Plane& plane, const Principal& s) {
  return plane.k * s[plane.i] - plane.l * s[plane.j] - plane.strength;
}

Principal flow(const Plane& plane) {
  Principal g{};
  g[plane.i] += plane.k_flow;
  g[plane.j] -= plane.l;
  return g;
}

// Elastic stiffness on principal strains: lame (tr g) + 2 G g.
Principal stiffness(double lame, double G, const Principal& g) {
  const double trace = lame * (g[0] + g[1] + g[2]);
  return {trace + 2.0 * G * g[0], trace + 2.0 * G * g[1], trace + 2.0 * G * g[2]};
}

struct ActiveSet {
  int count;
  std::array<int, 3> planes;
};

// In the order in which they are tried: plane, edges, tension, where the two meet, corners.
constexpr std::array<ActiveSet, 12> active_sets{{{1, {shear_13, 0, 0}},
                                                 {2, {shear_13, shear_23, 0}},
                                                 {2, {shear_13, shear_12, 0}},
                                                 {1, {tension_1, 0, 0}},
                                                 {2, {tension_1, shear_13, 0}},
                                                 {2, {tension_1, tension_2, 0}},
                                                 {3, {tension_1, tension_2, shear_13}},
                                                 {3, {tension_1, tension_2, shear_23}},
                                                 {3, {tension_1, shear_13, shear_12}},
                                                 {3, {tension_1, shear_13, shear_23}},
                                                 {3, {shear_13, shear_12, shear_23}},
                                                 {3, {tension_1, tension_2, tension_3}}}};

// Solves the 1 to 3 consistency conditions by Gaussian elimination with pivoting; false when they are dependent.
bool solve(int n, std::array<std::array<double, 4>, 3>& a, std::array<double, 3>& x) {
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int r = c + 1; r < n; ++r) {
      if (std::fabs(a[r][c]) > std::fabs(a[pivot][c])) pivot = r;
    }
    if (std::fabs(a[pivot][c]) < 1e-12 * (std::fabs(a[0][0]) + 1e-300)) return false;
    std::swap(a[pivot], a[c]);
    for (int r = 0; r < n; ++r) {
      if (r == c) continue;
      const double factor = a[r][c] / a[c][c];
      for (int k = c; k < 4; ++k) a[r][k] -= factor * a[c][k];
    }
  }
  for (int r = 0; r < n; ++r) x[r] = a[r][3] / a[r][r];
  return true;
}

struct PrincipalReturn {
  Principal stress{};
  Principal plastic{};  // plastic strain increment
  int planes = 0;
};

bool try_set(const ActiveSet& set, const std::array<Plane, plane_count>& planes, double lame, double G,
             const Principal& trial, double tolerance, PrincipalReturn& out) {
  std::array<std::array<double, 4>, 3> system{};
  for (int r = 0; r < set.count; ++r) {
    const Plane& plane = planes[set.planes[r]];
    for (int c = 0; c < set.count; ++c) {
      Plane linear = plane;
      linear.strength = 0.0;
      system[r][c] = value(linear, stiffness(lame, G, flow(planes[set.planes[c]])));
    }
    system[r][3] = value(plane, trial);
  }
  std::array<double, 3> multiplier{};
  if (!solve(set.count, system, multiplier)) return false;
  Principal plastic{};
  for (int r = 0; r < set.count; ++r) {
    if (multiplier[r] < -1e-14) return false;
    const Principal g = flow(planes[set.planes[r]]);
    for (int k = 0; k < 3; ++k) plastic[k] += multiplier[r] * g[k];
  }
  const Principal correction = stiffness(lame, G, plastic);
  Principal s{};
  for (int k = 0; k < 3; ++k) s[k] = trial[k] - correction[k];
  if (s[0] < s[1] - tolerance || s[1] < s[2] - tolerance) return false;
  for (const Plane& plane : planes) {
    if (value(plane, s) > tolerance) return false;
  }
  out = {s, plastic, set.count};
  return true;
}

// Principal stresses with the in-plane direction they belong to.
struct Decomposition {
  Principal s{};
  std::array<int, 3> axis{};  // 0, 1: in-plane major and minor; 2: out of plane
  double cos2 = 1.0;
  double sin2 = 0.0;
};

Decomposition decompose(const PlaneStrainStress& stress) {
  Decomposition d;
  const double centre = 0.5 * (stress.xx + stress.yy);
  const double half = 0.5 * (stress.xx - stress.yy);
  const double radius = std::hypot(half, stress.xy);
  if (radius > 0.0) {
    d.cos2 = half / radius;
    d.sin2 = stress.xy / radius;
  }
  const Principal raw{centre + radius, centre - radius, stress.zz};
  d.axis = {0, 1, 2};
  std::stable_sort(d.axis.begin(), d.axis.end(), [&](int a, int b) { return raw[a] > raw[b]; });
  for (int k = 0; k < 3; ++k) d.s[k] = raw[d.axis[k]];
  return d;
}

PlaneStrainStress compose(const Decomposition& d, const Principal& s) {
  Principal raw{};
  for (int k = 0; k < 3; ++k) raw[d.axis[k]] = s[k];
  const double centre = 0.5 * (raw[0] + raw[1]);
  const double radius = 0.5 * (raw[0] - raw[1]);
  return {centre + radius * d.cos2, centre - radius * d.cos2, raw[2], radius * d.sin2};
}

double largest_excess(const MohrCoulombLaw& law, const Principal& s) {
  return std::max(law.k * s[0] - s[2] - law.strength, s[0] - law.cutoff);
}

}  // namespace

MohrCoulombParameters MohrCoulombParameters::read(const CaseNode& node) {
  MohrCoulombParameters p;
  read_number(node, "poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
  p.shear_modulus = read_shear_modulus(node, p.poisson);
  p.cohesion = node.number("cohesion", "Pa", Range::non_negative());
  p.friction_angle = node.number("friction_angle", "deg", Range::between(0.0, 60.0));
  read_number(node, "dilation_angle", "deg", Range::between(0.0, p.friction_angle), p.dilation_angle);
  read_number(node, "tension_cutoff", "Pa", Range::non_negative(), p.tension_cutoff);
  p.density = node.number("density", "kg/m3", Range::positive());
  read_number(node, "porosity", "1", {0.0, 1.0, false, true}, p.pore_share);
  return p;
}

MohrCoulombLaw resolve(const MohrCoulombParameters& given) {
  MohrCoulombLaw law;
  law.shear_modulus = given.shear_modulus;
  law.poisson = given.poisson;
  const double phi = given.friction_angle * std::numbers::pi / 180.0;
  const double psi = given.dilation_angle * std::numbers::pi / 180.0;
  law.k = (1.0 + std::sin(phi)) / (1.0 - std::sin(phi));
  law.k_psi = (1.0 + std::sin(psi)) / (1.0 - std::sin(psi));
  law.strength = 2.0 * given.cohesion * std::sqrt(law.k);
  // Beyond the apex a cut-off has no meaning; phi = 0 has none.
  const double apex = std::tan(phi) > 1e-9 ? given.cohesion / std::tan(phi) : std::numeric_limits<double>::infinity();
  law.cutoff = std::min(given.tension_cutoff, apex);
  return law;
}

MohrCoulombReturn MohrCoulombLaw::to_yield(const PlaneStrainStress& trial) const {
  return return_to_yield(*this, shear_modulus, poisson, trial);
}

double yield_excess(const MohrCoulombLaw& law, const PlaneStrainStress& stress) {
  return largest_excess(law, decompose(stress).s);
}

MohrCoulombReturn return_to_yield(const MohrCoulombLaw& law, double G, double poisson, const PlaneStrainStress& trial) {
  const Decomposition d = decompose(trial);
  const double size = std::fabs(d.s[0]) + std::fabs(d.s[2]) + law.strength + 1.0;
  const double tolerance = 1e-11 * size;
  if (largest_excess(law, d.s) <= 1e-12 * size) return {trial, 0, 0.0, 0.0};
  const double lame = 2.0 * G * poisson / (1.0 - 2.0 * poisson);
  const auto planes = planes_of(law);
  PrincipalReturn result;
  bool found = false;
  for (const ActiveSet& set : active_sets) {
    found = try_set(set, planes, lame, G, d.s, tolerance, result);
    if (found) break;
  }
  if (!found) {
    // No set is consistent (a non-associated corner): the tension corner is always admissible.
    result.stress = {law.cutoff, law.cutoff, law.cutoff};
    result.planes = 3;
    const double change = (d.s[0] + d.s[1] + d.s[2]) / 3.0 - law.cutoff;
    const double volume = change / bulk_modulus(G, poisson);
    for (int k = 0; k < 3; ++k) {
      result.plastic[k] = volume / 3.0 + (d.s[k] - (d.s[0] + d.s[1] + d.s[2]) / 3.0) / (2.0 * G);
    }
  }
  // Order exactly, so that equal principal stresses of an edge stay equal after the rotation back.
  result.stress[1] = std::clamp(result.stress[1], result.stress[2], result.stress[0]);
  const double volume = result.plastic[0] + result.plastic[1] + result.plastic[2];
  double deviatoric = 0.0;
  for (const double e : result.plastic) deviatoric += (e - volume / 3.0) * (e - volume / 3.0);
  return {compose(d, result.stress), result.planes, std::sqrt(2.0 / 3.0 * deviatoric), volume};
}

}  // namespace tailrun::fem

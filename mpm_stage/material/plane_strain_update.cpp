// Stress update in plane strain, four particles at a time. There are no branches that depend on a particle (but for
// tension cut-off, seldom met): what a material does not have (softening, rate terms, tension cut-off) is left out at
// compile time.
#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mpm_stage/material/frozen_pore_pressure.hpp"
#include "mpm_stage/material/return_mapping.hpp"
#include "mpm_stage/material/strength.hpp"
#include "mpm_stage/material/stress_update.hpp"

namespace tailrun::mpm {

namespace {

struct Columns {
  double* __restrict gxx, * __restrict gxy, * __restrict gyx, * __restrict gyy;
  double* __restrict sxx, * __restrict syy, * __restrict szz, * __restrict sxy;
  double* __restrict volume, * __restrict strain, * __restrict strength, * __restrict mass;
  const double* __restrict trace;

  Columns(Particles<2>& P, const double* trace_of_run, std::size_t begin)
      : gxx(P.gradient[0].data() + begin),
        gxy(P.gradient[1].data() + begin),
        gyx(P.gradient[2].data() + begin),
        gyy(P.gradient[3].data() + begin),
        sxx(P.stress[0].data() + begin),
        syy(P.stress[1].data() + begin),
        szz(P.stress[2].data() + begin),
        sxy(P.stress[3].data() + begin),
        volume(P.volume.data() + begin),
        strain(P.plastic_strain.data() + begin),
        strength(P.strength.data() + begin),
        mass(P.mass.data() + begin),
        trace(trace_of_run) {}
};

// Mean and deviator of the in-plane trial stress: sxx = p + q, syy = p - q, sxy = r. `volume_ratio` is det F of the
// averaged increment, 2-D: ((1 + t/4) / (1 - t/4))^2 with t its midpoint trace.
struct PlaneTrial {
  Vec4 p, q, r, zz, shear_rate_squared, volume_ratio;
};

template <class G>
[[gnu::always_inline]] inline PlaneTrial elastic_trial(const MaterialConstants& k, const Columns& c, const G& g) {
  const Vec4 gxx = g.read(c.gxx), gxy = g.read(c.gxy), gyx = g.read(c.gyx), gyy = g.read(c.gyy);
  const Vec4 sxx = g.read(c.sxx), syy = g.read(c.syy), sxy = g.read(c.sxy);
  const Vec4 trace = g.read(c.trace);
  // Hughes & Winget: Q = (I - W/2)^-1 (I + W/2) turns by theta with tan(theta / 2) = w / 2; the deviator turns by 2
  // theta. One division serves the rotation and the change of volume.
  const Vec4 t = 0.25 * (gyx - gxy), tt = t * t, shrunk = 1.0 - 0.25 * trace;
  const Vec4 both = 1.0 / ((1.0 + tt) * shrunk), r1 = both * shrunk;
  const Vec4 cosine = (1.0 - tt) * r1, sine = 2.0 * t * r1;
  const Vec4 c2 = cosine * cosine - sine * sine, s2 = 2.0 * cosine * sine;
  const Vec4 q0 = 0.5 * (sxx - syy), p0 = 0.5 * (sxx + syy);
  const Vec4 de = 0.5 * (gxx - gyy), dg = 0.5 * (gxy + gyx);
  const Vec4 growth = (1.0 + 0.25 * trace) * (both * (1.0 + tt));
  PlaneTrial o;
  o.p = p0 + (k.lambda + k.mu) * trace;
  o.q = q0 * c2 - sxy * s2 + 2.0 * k.mu * de;
  o.r = q0 * s2 + sxy * c2 + 2.0 * k.mu * dg;
  o.zz = g.read(c.szz) + k.lambda * trace;
  o.shear_rate_squared = 4.0 * (de * de + dg * dg);
  o.volume_ratio = growth * growth;
  return o;
}

void linear_elastic(const MaterialConstants& k, const Columns& c, std::size_t n) {
  for_each_group(
      0, n, [&](const auto& g) __attribute__((always_inline)) {
        const PlaneTrial t = elastic_trial(k, c, g);
        g.write(c.sxx, t.p + t.q);
        g.write(c.syy, t.p - t.q);
        g.write(c.szz, t.zz);
        g.write(c.sxy, t.r);
        g.write(c.volume, g.read(c.volume) * t.volume_ratio);
      });
}

// Plastic strain increment from the stress that the return took away: de = C^-1 (s_trial - s). Returns the work s : de
// per unit volume and adds to the deviatoric plastic strain.
struct PlasticWork {
  Vec4 work, strain;
};

[[gnu::always_inline]] inline PlasticWork plastic_work(double shear_flexibility, double volume_flexibility,
                                                       const PrincipalOf<Vec4>& t, const PrincipalOf<Vec4>& s) {
  const Vec4 d1 = t.s1 - s.s1, d2 = t.s2 - s.s2, d3 = t.s3 - s.s3;
  const Vec4 mean = (d1 + d2 + d3) * (1.0 / 3.0), b = mean * volume_flexibility;
  const Vec4 e1 = shear_flexibility * (d1 - mean), e2 = shear_flexibility * (d2 - mean);
  const Vec4 e3 = shear_flexibility * (d3 - mean);
  return {s.s1 * (e1 + b) + s.s2 * (e2 + b) + s.s3 * (e3 + b), root(2.0 / 3.0 * (e1 * e1 + e2 * e2 + e3 * e3))};
}

// The lanes of `s` that lie above the tension cut-off, from their trial `t`.
inline void cut_off(const MaterialConstants& k, Vec4 sin_phi, Vec4 cohesion, const PrincipalOf<Vec4>& t,
                    PrincipalOf<Vec4>& s) {
  for (int l = 0; l < 4; ++l) {
    if (!(s.s1[l] > k.tension)) continue;
    const Principal r =
        return_tension_cutoff(k, sin_phi[l], cohesion[l], k.tension, Principal{t.s1[l], t.s2[l], t.s3[l]});
    s.s1[l] = r.s1;
    s.s2[l] = r.s2;
    s.s3[l] = r.s3;
  }
}

// Frictional: Mohr-Coulomb, else Tresca. The in-plane principal stresses p +- R and zz are sorted without branches and
// put back by where zz stood.
template <bool Frictional, bool Softens, bool Rate, bool Cutoff>
double elasto_plastic(const MaterialConstants& k, const Columns& c, std::size_t n, double dt) {
  Vec4 dissipated = {};
  const Vec4 zero = {};
  const double per_dt = dt > 0.0 ? 1.0 / dt : 0.0;
  const MohrCoulombSurface surface = Frictional ? mohr_coulomb_surface(k, k.sin_phi) : MohrCoulombSurface{};
  const double shear_flexibility = 0.5 / k.mu, volume_flexibility = 1.0 / (3.0 * k.bulk);
  // In two loops over a few particles, not in one: each particle's numbers follow from one another through some 200
  // cycles, and only where the next particles' do not wait behind them is the core kept busy.
  constexpr std::size_t few = 64;
  PlaneTrial trials[few / 4];
  for (std::size_t first = 0; first < n; first += few) {
    const std::size_t last = std::min(n, first + few);
    const auto number = [first](const auto& g) { return (g.first - first) / 4; };
    for_each_group(
        first, last, [&](const auto& g) __attribute__((always_inline)) { trials[number(g)] = elastic_trial(k, c, g); });
    for_each_group(
        first, last, [&](const auto& g) __attribute__((always_inline)) {
          const PlaneTrial& t = trials[number(g)];
          const Vec4 R = root(t.q * t.q + t.r * t.r), per_R = R > zero ? 0.5 / R : zero;
          const Vec4 a = t.p + R, b = t.p - R, z = t.zz;
          const PrincipalOf<Vec4> trial = {larger(a, z), larger(b, smaller(a, z)), smaller(b, z)};
          Vec4 cohesion = g.read(c.strength), sin_phi = splat(k.sin_phi);
          const Vec4 strain = g.read(c.strain);
          if constexpr (Softens) {
            const Vec4 share = softening_share(k, strain);
            cohesion = softened_cohesion(k, cohesion, share);
            sin_phi = softened_sin_phi(k, share);
          }
          if constexpr (Rate) cohesion += rate_strength<Vec4>(k, root(t.shear_rate_squared) * per_dt);
          PrincipalOf<Vec4> s;
          if constexpr (!Frictional)
            s = return_tresca(cohesion, trial);
          else if constexpr (Softens)
            s = return_mohr_coulomb(mohr_coulomb_surface(k, sin_phi), cohesion, trial);
          else
            s = return_mohr_coulomb(surface, cohesion, trial);
          if constexpr (Cutoff) cut_off(k, sin_phi, cohesion, trial, s);
          const PlasticWork w = plastic_work(shear_flexibility, volume_flexibility, trial, s);
          const auto z_first = z > a, z_last = z < b;
          const Vec4 a1 = z_first ? s.s2 : s.s1, b1 = z_last ? s.s2 : s.s3;
          const Vec4 p1 = 0.5 * (a1 + b1), scale = (a1 - b1) * per_R, q1 = t.q * scale;
          g.write(c.sxx, p1 + q1);
          g.write(c.syy, p1 - q1);
          g.write(c.szz, z_first ? s.s1 : (z_last ? s.s3 : s.s2));
          g.write(c.sxy, t.r * scale);
          g.write(c.strain, strain + w.strain);
          const Vec4 most = k.largest_specific_volume * g.read(c.mass);
          const Vec4 volume = smaller(g.read(c.volume) * t.volume_ratio, most);
          g.write(c.volume, volume);
          dissipated += g.only(w.work * volume);
        });
  }
  return sum_of_lanes(dissipated);
}

template <bool Frictional, bool Cutoff>
double choose_strength_law(const MaterialConstants& k, const Columns& c, std::size_t n, double dt) {
  const bool rate = k.consistency > 0.0;
  if (k.softens)
    return rate ? elasto_plastic<Frictional, true, true, Cutoff>(k, c, n, dt)
                : elasto_plastic<Frictional, true, false, Cutoff>(k, c, n, dt);
  return rate ? elasto_plastic<Frictional, false, true, Cutoff>(k, c, n, dt)
              : elasto_plastic<Frictional, false, false, Cutoff>(k, c, n, dt);
}

// Weakly compressible Newtonian fluid: p = K (rho / rho_0 - 1), s = -p I + 2 eta dev(D).
double newtonian_fluid(const MaterialConstants& k, const Columns& c, std::size_t n, double dt) {
  Vec4 dissipated = {};
  const double viscous = dt > 0.0 ? 2.0 * k.consistency / dt : 0.0;
  const Vec4 low = splat(k.allow_tension ? -k.bulk : 0.0);
  for_each_group(
      0, n, [&](const auto& g) __attribute__((always_inline)) {
        const Vec4 t = g.read(c.trace);
        const Vec4 growth = (1.0 + 0.25 * t) / (1.0 - 0.25 * t), volume = g.read(c.volume) * (growth * growth);
        const Vec4 pressure = larger(low, k.bulk * (g.read(c.mass) / (volume * k.reference_density) - 1.0));
        const Vec4 gxx = g.read(c.gxx), gyy = g.read(c.gyy), third = (gxx + gyy) * (1.0 / 3.0);
        const Vec4 exx = gxx - third, eyy = gyy - third, exy = 0.5 * (g.read(c.gxy) + g.read(c.gyx));
        g.write(c.volume, volume);
        g.write(c.sxx, viscous * exx - pressure);
        g.write(c.syy, viscous * eyy - pressure);
        g.write(c.szz, -(viscous * third) - pressure);
        g.write(c.sxy, viscous * exy);
        dissipated += g.only(viscous * (exx * exx + eyy * eyy + third * third + 2.0 * exy * exy) * volume);
      });
  return sum_of_lanes(dissipated);
}

double update_skeleton(const MaterialConstants& k, const Columns& c, std::size_t n, double dt) {
  const bool cutoff = k.tension >= 0.0;
  switch (k.model) {
    case Model::linear_elastic:
      linear_elastic(k, c, n);
      return 0.0;
    case Model::mohr_coulomb:
      return cutoff ? choose_strength_law<true, true>(k, c, n, dt) : choose_strength_law<true, false>(k, c, n, dt);
    case Model::tresca:
      return cutoff ? choose_strength_law<false, true>(k, c, n, dt) : choose_strength_law<false, false>(k, c, n, dt);
    case Model::newtonian_fluid:
      return newtonian_fluid(k, c, n, dt);
    case Model::rigid:
      break;
  }
  throw ComputationError("a rigid material has no stress update");
}

}  // namespace

StressWork update_stress(const MaterialConstants& k, Particles<2>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt) {
  if (k.pore_pressure == PorePressure::undrained)
    for (std::size_t p = begin; p < end; ++p) P.pore_pressure[p] -= k.pore_stiffness * trace[p - begin];
  FrozenPorePressure<2> water(k, P, begin, end, trace);
  const double dissipated = update_skeleton(k, Columns(P, trace, begin), end - begin, dt);
  return {dissipated, water.release()};
}

double elastic_energy(const MaterialConstants& k, const Particles<2>& P, std::size_t begin, std::size_t end) {
  double energy = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double xx = P.stress[0][p], yy = P.stress[1][p], zz = P.stress[2][p], xy = P.stress[3][p];
    const double mean = (xx + yy + zz) / 3.0;
    if (k.model == Model::newtonian_fluid) {
      energy += stored_in_fluid(k, P.mass[p], P.volume[p]);
    } else {
      const double dev =
          (xx - mean) * (xx - mean) + (yy - mean) * (yy - mean) + (zz - mean) * (zz - mean) + 2.0 * xy * xy;
      energy += (0.25 * dev / k.mu + 0.5 * mean * mean / k.bulk) * P.volume[p];
    }
    if (k.pore_pressure == PorePressure::undrained)
      energy += 0.5 * P.pore_pressure[p] * P.pore_pressure[p] / k.pore_stiffness * P.volume[p];
  }
  return energy;
}

}  // namespace tailrun::mpm

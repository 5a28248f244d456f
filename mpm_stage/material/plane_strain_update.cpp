// Stress update in plane strain. The loops have no branches that depend on a particle: what a material does not have
// (softening, rate terms, tension cut-off) is left out at compile time, and the compiler makes vector code of the rest.
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
  const double* __restrict trace, * __restrict shift;

  Columns(Particles<2>& P, const double* trace_of_run, const double* shift_of_run, std::size_t begin)
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
        trace(trace_of_run),
        shift(shift_of_run) {}
};

// Mean and deviator of the in-plane trial stress: sxx = p + q, syy = p - q, sxy = r.
struct PlaneTrial {
  double p, q, r, zz, shear_rate_squared;
};

[[gnu::always_inline]] inline PlaneTrial elastic_trial(const MaterialConstants& k, double gxx, double gxy, double gyx,
                                                       double gyy, double trace, double shift, double sxx, double syy,
                                                       double szz, double sxy) {
  // Hughes & Winget: Q = (I - W/2)^-1 (I + W/2) turns by theta with tan(theta / 2) = w / 2; the deviator turns by 2
  // theta.
  const double t = 0.25 * (gyx - gxy), tt = t * t, r1 = 1.0 / (1.0 + tt);
  const double c = (1.0 - tt) * r1, s = 2.0 * t * r1;
  const double c2 = c * c - s * s, s2 = 2.0 * c * s;
  const double q0 = 0.5 * (sxx - syy), p0 = 0.5 * (sxx + syy);
  const double de = 0.5 * (gxx - gyy), dg = 0.5 * (gxy + gyx);
  PlaneTrial o;
  o.p = p0 + (k.lambda + k.mu) * trace + shift;
  o.q = q0 * c2 - sxy * s2 + 2.0 * k.mu * de;
  o.r = q0 * s2 + sxy * c2 + 2.0 * k.mu * dg;
  o.zz = szz + k.lambda * trace + shift;
  o.shear_rate_squared = 4.0 * (de * de + dg * dg);
  return o;
}

// det F of the averaged increment, 2-D: ((1 + t/4) / (1 - t/4))^2 with t its midpoint trace.
inline double volume_ratio(double trace) {
  const double r = (1.0 + 0.25 * trace) / (1.0 - 0.25 * trace);
  return r * r;
}

void linear_elastic(const MaterialConstants& k, const Columns& c, std::size_t n) {
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const PlaneTrial t = elastic_trial(k, c.gxx[i], c.gxy[i], c.gyx[i], c.gyy[i], c.trace[i], c.shift[i], c.sxx[i],
                                       c.syy[i], c.szz[i], c.sxy[i]);
    c.sxx[i] = t.p + t.q;
    c.syy[i] = t.p - t.q;
    c.szz[i] = t.zz;
    c.sxy[i] = t.r;
    c.volume[i] *= volume_ratio(c.trace[i]);
  }
}

// Plastic strain increment from the stress that the return took away: de = C^-1 (s_trial - s). Returns the work s : de
// per unit volume and adds to the deviatoric plastic strain.
struct PlasticWork {
  double work, strain;
};

[[gnu::always_inline]] inline PlasticWork plastic_work(double shear_flexibility, double volume_flexibility, Principal t,
                                                       Principal s) {
  const double d1 = t.s1 - s.s1, d2 = t.s2 - s.s2, d3 = t.s3 - s.s3;
  const double mean = (d1 + d2 + d3) * (1.0 / 3.0), b = mean * volume_flexibility;
  const double e1 = shear_flexibility * (d1 - mean), e2 = shear_flexibility * (d2 - mean);
  const double e3 = shear_flexibility * (d3 - mean);
  return {s.s1 * (e1 + b) + s.s2 * (e2 + b) + s.s3 * (e3 + b), std::sqrt(2.0 / 3.0 * (e1 * e1 + e2 * e2 + e3 * e3))};
}

// Frictional: Mohr-Coulomb, else Tresca. The in-plane principal stresses p +- R and zz are sorted without branches and
// put back by where zz stood.
template <bool Frictional, bool Softens, bool Rate, bool Cutoff>
double elasto_plastic(const MaterialConstants& k, const Columns& c, std::size_t n, double dt) {
  double dissipated = 0.0;
  const double per_dt = dt > 0.0 ? 1.0 / dt : 0.0;
  const MohrCoulombSurface surface = Frictional ? mohr_coulomb_surface(k, k.sin_phi) : MohrCoulombSurface{};
  const double shear_flexibility = 0.5 / k.mu, volume_flexibility = 1.0 / (3.0 * k.bulk);
  const auto body = [&](std::size_t i) __attribute__((always_inline)) {
    const PlaneTrial t = elastic_trial(k, c.gxx[i], c.gxy[i], c.gyx[i], c.gyy[i], c.trace[i], c.shift[i], c.sxx[i],
                                       c.syy[i], c.szz[i], c.sxy[i]);
    const double R = std::sqrt(t.q * t.q + t.r * t.r);
    const double a = t.p + R, b = t.p - R, z = t.zz;
    const Principal trial = {std::max(a, z), std::max(b, std::min(a, z)), std::min(b, z)};
    double cohesion = c.strength[i], sin_phi = k.sin_phi;
    if constexpr (Softens) {
      const double share = softening_share(k, c.strain[i]);
      cohesion = softened_cohesion(k, cohesion, share);
      sin_phi = softened_sin_phi(k, share);
    }
    if constexpr (Rate) cohesion += rate_strength(k, std::sqrt(t.shear_rate_squared) * per_dt);
    Principal s;
    if constexpr (Frictional)
      s = return_mohr_coulomb(Softens ? mohr_coulomb_surface(k, sin_phi) : surface, cohesion, trial);
    else
      s = return_tresca(cohesion, trial);
    if constexpr (Cutoff) {
      if (s.s1 > k.tension) s = return_tension_cutoff(k, sin_phi, cohesion, k.tension, trial);
    }
    const PlasticWork w = plastic_work(shear_flexibility, volume_flexibility, trial, s);
    const bool z_first = z > a, z_last = z < b;
    const double a1 = z_first ? s.s2 : s.s1, b1 = z_last ? s.s2 : s.s3;
    const double z1 = z_first ? s.s1 : (z_last ? s.s3 : s.s2);
    const double p1 = 0.5 * (a1 + b1), scale = R > 0.0 ? 0.5 * (a1 - b1) / R : 0.0;
    const double q1 = t.q * scale;
    c.sxx[i] = p1 + q1;
    c.syy[i] = p1 - q1;
    c.szz[i] = z1;
    c.sxy[i] = t.r * scale;
    c.strain[i] += w.strain;
    c.volume[i] = std::min(c.volume[i] * volume_ratio(c.trace[i]), k.largest_specific_volume * c.mass[i]);
    return w.work * c.volume[i];
  };
  if constexpr (Cutoff) {
    for (std::size_t i = 0; i < n; ++i) dissipated += body(i);
  } else {
#pragma omp simd reduction(+ : dissipated)
    for (std::size_t i = 0; i < n; ++i) dissipated += body(i);
  }
  return dissipated;
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
  double dissipated = 0.0;
  const double viscous = dt > 0.0 ? 2.0 * k.consistency / dt : 0.0, low = k.allow_tension ? -k.bulk : 0.0;
#pragma omp simd reduction(+ : dissipated)
  for (std::size_t i = 0; i < n; ++i) {
    c.volume[i] *= volume_ratio(c.trace[i] + c.shift[i] / k.bulk);
    const double pressure = std::max(low, k.bulk * (c.mass[i] / (c.volume[i] * k.reference_density) - 1.0));
    const double own = c.gxx[i] + c.gyy[i], exx = c.gxx[i] - own / 3.0, eyy = c.gyy[i] - own / 3.0, ezz = -own / 3.0;
    const double exy = 0.5 * (c.gxy[i] + c.gyx[i]);
    c.sxx[i] = -pressure + viscous * exx;
    c.syy[i] = -pressure + viscous * eyy;
    c.szz[i] = -pressure + viscous * ezz;
    c.sxy[i] = viscous * exy;
    dissipated += viscous * (exx * exx + eyy * eyy + ezz * ezz + 2.0 * exy * exy) * c.volume[i];
  }
  return dissipated;
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
                         const double* trace, const double* shift, double dt) {
  if (k.pore_pressure == PorePressure::undrained)
    for (std::size_t p = begin; p < end; ++p) P.pore_pressure[p] -= k.pore_stiffness * trace[p - begin];
  FrozenPorePressure<2> water(k, P, begin, end, trace, shift);
  const double dissipated = update_skeleton(k, Columns(P, trace, shift, begin), end - begin, dt);
  return {dissipated, water.release()};
}

double elastic_energy(const MaterialConstants& k, const Particles<2>& P, std::size_t begin, std::size_t end) {
  double energy = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double xx = P.stress[0][p], yy = P.stress[1][p], zz = P.stress[2][p], xy = P.stress[3][p];
    const double mean = (xx + yy + zz) / 3.0;
    if (k.model == Model::newtonian_fluid) {
      energy += 0.5 * mean * mean / k.bulk * P.volume[p];
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

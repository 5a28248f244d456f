// The loops of a law that is elastic up to a yield surface in principal stresses and returns to it in closed form. The
// loops are the same for each such law: trial, principal stresses, strength as it is now, return, tension cut-off, back
// to the stress, plastic work. What differs is a class of the law's file:
//
//   struct Law {
//     // Once per run of particles. A law whose strength follows the plastic rate of the step itself takes its length,
//     // `dt` (s, 0: no rate), as a second argument.
//     explicit Law(const MaterialConstants& k);
//     // The return of `trial` at the cohesion (Pa), without branches so that loops over particles become vector code.
//     // `share` is that of strength.hpp, 1 at peak and 0 at residual, and counts only if the material Softens. `Real`
//     // is one particle's number or four particles'.
//     template <bool Softens, class Real>
//     PrincipalOf<Real> returned(Real cohesion, Real share, PrincipalOf<Real> trial) const;
//     template <bool Softens, class Real>
//     Real sin_phi(Real share) const;  // for the cut-off
//   };
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "mpm_stage/material/elastic_energy.hpp"
#include "mpm_stage/material/plane_strain.hpp"
#include "mpm_stage/material/principal_stress.hpp"
#include "mpm_stage/material/strength.hpp"
#include "mpm_stage/material/three_dimensions.hpp"

namespace tailrun::mpm {

template <class Law>
Law law_of_step(const MaterialConstants& k, double dt) {
  if constexpr (std::is_constructible_v<Law, const MaterialConstants&, double>)
    return Law(k, dt);
  else
    return Law(k);
}

// Plane strain. What a material does not have (softening, rate terms, tension cut-off) is left out at compile time. The
// in-plane principal stresses p +- R and zz are sorted without branches and put back by where zz stood.
template <class Law, bool Softens, bool Rate, bool Cutoff>
double elasto_plastic_plane(const MaterialConstants& k, Particles<2>& P, std::size_t begin, std::size_t end,
                            const double* run_trace, double dt) {
  const PlaneColumns c(P, run_trace, begin);
  const std::size_t n = end - begin;
  Vec4 dissipated = {};
  const Vec4 zero = {};
  const double per_dt = dt > 0.0 ? 1.0 / dt : 0.0;
  const Law law = law_of_step<Law>(k, dt);
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
          Vec4 cohesion = g.read(c.strength), share = zero;
          const Vec4 strain = g.read(c.strain);
          if constexpr (Softens) {
            share = softening_share(k, strain);
            cohesion = softened_cohesion(k, cohesion, share);
          }
          if constexpr (Rate) cohesion += rate_strength<Vec4>(k, root(t.shear_rate_squared) * per_dt);
          PrincipalOf<Vec4> s = law.template returned<Softens>(cohesion, share, trial);
          if constexpr (Cutoff) cut_off(k, law.template sin_phi<Softens>(share), cohesion, trial, s);
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

// One particle's return, cut-off included.
template <bool Softens, class Law>
Principal returned_and_cut_off(const MaterialConstants& k, const Law& law, double cohesion, double share,
                               const Principal& trial) {
  const Principal r = law.template returned<Softens>(cohesion, share, trial);
  if (!(k.tension >= 0.0 && r.s1 > k.tension)) return r;
  return return_tension_cutoff(k, law.template sin_phi<Softens>(share), cohesion, k.tension, trial);
}

// Returns the dissipated energy per unit volume. `rate` 1/s, of shear.
template <class Law>
double return_to_yield(const MaterialConstants& k, const Law& law, double cohesion, double rate, Matrix3& s,
                       double& plastic_strain) {
  Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
  eigen.compute(s);
  const Eigen::Vector3d v = eigen.eigenvalues();
  const Principal trial = {v(2), v(1), v(0)};
  double share = 0.0;
  if (k.softens) {
    share = softening_share(k, plastic_strain);
    cohesion = softened_cohesion(k, cohesion, share);
  }
  if (k.consistency > 0.0) cohesion += rate_strength(k, rate);
  const Principal r = k.softens ? returned_and_cut_off<true>(k, law, cohesion, share, trial)
                                : returned_and_cut_off<false>(k, law, cohesion, share, trial);
  const Eigen::Vector3d after(r.s3, r.s2, r.s1), lost = v - after;
  if (lost.squaredNorm() == 0.0) return 0.0;
  s = eigen.eigenvectors() * after.asDiagonal() * eigen.eigenvectors().transpose();
  const double mean = lost.mean();
  const Eigen::Vector3d e = (lost.array() - mean).matrix() * (0.5 / k.mu);
  plastic_strain += std::sqrt(2.0 / 3.0) * e.norm();
  return after.dot(e) + after.sum() * mean / (3.0 * k.bulk);
}

template <class Law>
double elasto_plastic_solid(const MaterialConstants& k, Particles<3>& P, std::size_t begin, std::size_t end,
                            const double* trace, double dt) {
  const Law law = law_of_step<Law>(k, dt);
  double dissipated = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double t = trace[p - begin];
    const Matrix3 G = gradient_matrix(P, p), e = deviator_of(G);
    P.volume[p] *= volume_ratio(t);
    Matrix3 s = elastic_trial(k, P, p, G, e, t);
    P.volume[p] = std::min(P.volume[p], k.largest_specific_volume * P.mass[p]);
    dissipated += P.volume[p] * return_to_yield(k, law, P.strength[p], dt > 0.0 ? std::sqrt(2.0) * e.norm() / dt : 0.0,
                                                s, P.plastic_strain[p]);
    store(P, p, s);
  }
  return dissipated;
}

// For MaterialLaw::returned.
template <class Law>
Principal elasto_plastic_return(const MaterialConstants& k, double cohesion, const Principal& trial) {
  return returned_and_cut_off<false>(k, Law(k), cohesion, 0.0, trial);
}

// The loops of a material whose strength's constants are set.
template <class Law>
void set_elasto_plastic_loops(MaterialConstants& k) {
  const auto choose = [&]<bool Softens, bool Rate>() {
    return k.tension >= 0.0 ? elasto_plastic_plane<Law, Softens, Rate, true>
                            : elasto_plastic_plane<Law, Softens, Rate, false>;
  };
  const bool rate = k.consistency > 0.0;
  if (k.softens)
    k.plane.update = rate ? choose.template operator()<true, true>() : choose.template operator()<true, false>();
  else
    k.plane.update = rate ? choose.template operator()<false, true>() : choose.template operator()<false, false>();
  k.solid.update = elasto_plastic_solid<Law>;
  k.plane.energy = isotropic_energy;
  k.solid.energy = isotropic_energy;
}

}  // namespace tailrun::mpm

// Stress update in three dimensions.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mpm_stage/material/frozen_pore_pressure.hpp"
#include "mpm_stage/material/return_mapping.hpp"
#include "mpm_stage/material/strength.hpp"
#include "mpm_stage/material/stress_update.hpp"

namespace tailrun::mpm {

namespace {

using Matrix = Eigen::Matrix3d;

Matrix stress_matrix(const Particles<3>& P, std::size_t p) {
  Matrix s;
  s << P.stress[0][p], P.stress[3][p], P.stress[5][p], P.stress[3][p], P.stress[1][p], P.stress[4][p], P.stress[5][p],
      P.stress[4][p], P.stress[2][p];
  return s;
}

void store(Particles<3>& P, std::size_t p, const Matrix& s) {
  P.stress[0][p] = s(0, 0);
  P.stress[1][p] = s(1, 1);
  P.stress[2][p] = s(2, 2);
  P.stress[3][p] = s(0, 1);
  P.stress[4][p] = s(1, 2);
  P.stress[5][p] = s(0, 2);
}

Matrix gradient_matrix(const Particles<3>& P, std::size_t p) {
  Matrix g;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g(i, j) = P.gradient[3 * i + j][p];
  return g;
}

// Hughes & Winget (1980): Q = (I - W/2)^-1 (I + W/2) with W = skew(G).
Matrix rotated(const Matrix& s, const Matrix& G) {
  const Matrix half = 0.25 * (G - G.transpose());
  const Matrix Q = (Matrix::Identity() - half).inverse() * (Matrix::Identity() + half);
  return Q * s * Q.transpose();
}

double volume_ratio(double trace) {
  const double r = (1.0 + trace / 6.0) / (1.0 - trace / 6.0);
  return r * r * r;
}

// Returns the dissipated energy per unit volume.
double return_to_yield(const MaterialConstants& k, double strength, double rate, Matrix& s, double& plastic_strain) {
  Eigen::SelfAdjointEigenSolver<Matrix> eigen;
  eigen.compute(s);
  const Eigen::Vector3d v = eigen.eigenvalues();
  const Principal trial = {v(2), v(1), v(0)};
  double cohesion = strength, sin_phi = k.sin_phi;
  if (k.softens) {
    const double share = softening_share(k, plastic_strain);
    cohesion = softened_cohesion(k, cohesion, share);
    sin_phi = softened_sin_phi(k, share);
  }
  if (k.consistency > 0.0) cohesion += rate_strength(k, rate);
  Principal r = k.model == Model::mohr_coulomb ? return_mohr_coulomb(mohr_coulomb_surface(k, sin_phi), cohesion, trial)
                                               : return_tresca(cohesion, trial);
  if (k.tension >= 0.0 && r.s1 > k.tension) r = return_tension_cutoff(k, sin_phi, cohesion, k.tension, trial);
  const Eigen::Vector3d after(r.s3, r.s2, r.s1), lost = v - after;
  if (lost.squaredNorm() == 0.0) return 0.0;
  s = eigen.eigenvectors() * after.asDiagonal() * eigen.eigenvectors().transpose();
  const double mean = lost.mean();
  const Eigen::Vector3d e = (lost.array() - mean).matrix() * (0.5 / k.mu);
  plastic_strain += std::sqrt(2.0 / 3.0) * e.norm();
  return after.dot(e) + after.sum() * mean / (3.0 * k.bulk);
}

}  // namespace

StressWork update_stress(const MaterialConstants& k, Particles<3>& P, std::size_t begin, std::size_t end,
                         const double* trace, double dt) {
  double dissipated = 0.0;
  FrozenPorePressure<3> water(k, P, begin, end, trace);
  for (std::size_t p = begin; p < end; ++p) {
    const double t = trace[p - begin];
    const Matrix G = gradient_matrix(P, p), D = 0.5 * (G + G.transpose());
    const Matrix e = D - D.trace() / 3.0 * Matrix::Identity();
    P.volume[p] *= volume_ratio(t);
    if (k.pore_pressure == PorePressure::undrained) P.pore_pressure[p] -= k.pore_stiffness * t;
    if (k.model == Model::newtonian_fluid) {
      const double low = k.allow_tension ? -k.bulk : 0.0;
      const double pressure = std::max(low, k.bulk * (P.mass[p] / (P.volume[p] * k.reference_density) - 1.0));
      const double viscous = dt > 0.0 ? 2.0 * k.consistency / dt : 0.0;
      store(P, p, viscous * e - pressure * Matrix::Identity());
      dissipated += viscous * e.squaredNorm() * P.volume[p];
      continue;
    }
    if (k.model == Model::rigid) throw ComputationError("a rigid material has no stress update");
    Matrix s = rotated(stress_matrix(P, p), G) + 2.0 * k.mu * e + k.bulk * t * Matrix::Identity();
    if (k.model != Model::linear_elastic) {
      P.volume[p] = std::min(P.volume[p], k.largest_specific_volume * P.mass[p]);
      dissipated += P.volume[p] * return_to_yield(k, P.strength[p], dt > 0.0 ? std::sqrt(2.0) * e.norm() / dt : 0.0, s,
                                                  P.plastic_strain[p]);
    }
    store(P, p, s);
  }
  return {dissipated, water.release()};
}

double elastic_energy(const MaterialConstants& k, const Particles<3>& P, std::size_t begin, std::size_t end) {
  double energy = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const Matrix s = stress_matrix(P, p);
    const double mean = s.trace() / 3.0;
    double density = 0.5 * mean * mean / k.bulk + 0.25 * (s - mean * Matrix::Identity()).squaredNorm() / k.mu;
    if (k.model == Model::newtonian_fluid) density = stored_in_fluid(k, P.mass[p], P.volume[p]) / P.volume[p];
    if (k.pore_pressure == PorePressure::undrained)
      density += 0.5 * P.pore_pressure[p] * P.pore_pressure[p] / k.pore_stiffness;
    energy += density * P.volume[p];
  }
  return energy;
}

}  // namespace tailrun::mpm

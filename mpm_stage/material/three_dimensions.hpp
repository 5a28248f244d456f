// Stress update in three dimensions, one particle at a time: tensors of particles as matrices, and the elastic trial.
#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "mpm_stage/material/material.hpp"
#include "mpm_stage/particles/particles.hpp"

namespace tailrun::mpm {

using Matrix3 = Eigen::Matrix3d;

inline Matrix3 stress_matrix(const Particles<3>& P, std::size_t p) {
  Matrix3 s;
  s << P.stress[0][p], P.stress[3][p], P.stress[5][p], P.stress[3][p], P.stress[1][p], P.stress[4][p], P.stress[5][p],
      P.stress[4][p], P.stress[2][p];
  return s;
}

inline void store(Particles<3>& P, std::size_t p, const Matrix3& s) {
  P.stress[0][p] = s(0, 0);
  P.stress[1][p] = s(1, 1);
  P.stress[2][p] = s(2, 2);
  P.stress[3][p] = s(0, 1);
  P.stress[4][p] = s(1, 2);
  P.stress[5][p] = s(0, 2);
}

inline Matrix3 gradient_matrix(const Particles<3>& P, std::size_t p) {
  Matrix3 g;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g(i, j) = P.gradient[3 * i + j][p];
  return g;
}

// Deviatoric strain increment of the midpoint gradient G.
inline Matrix3 deviator_of(const Matrix3& G) {
  const Matrix3 D = 0.5 * (G + G.transpose());
  return D - D.trace() / 3.0 * Matrix3::Identity();
}

// Hughes & Winget (1980): Q = (I - W/2)^-1 (I + W/2) with W = skew(G).
inline Matrix3 rotated(const Matrix3& s, const Matrix3& G) {
  const Matrix3 half = 0.25 * (G - G.transpose());
  const Matrix3 Q = (Matrix3::Identity() - half).inverse() * (Matrix3::Identity() + half);
  return Q * s * Q.transpose();
}

// det F of the averaged increment with midpoint trace `trace`.
inline double volume_ratio(double trace) {
  const double r = (1.0 + trace / 6.0) / (1.0 - trace / 6.0);
  return r * r * r;
}

// Stress of particle p, turned, and with the elastic increment of the deviatoric strain `e` and the volumetric one
// `trace`.
inline Matrix3 elastic_trial(const MaterialConstants& k, const Particles<3>& P, std::size_t p, const Matrix3& G,
                             const Matrix3& e, double trace) {
  return rotated(stress_matrix(P, p), G) + 2.0 * k.mu * e + k.bulk * trace * Matrix3::Identity();
}

}  // namespace tailrun::mpm

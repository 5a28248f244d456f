#include "mpm_stage/material/elastic_energy.hpp"

#include "mpm_stage/material/three_dimensions.hpp"

namespace tailrun::mpm {

double isotropic_energy(const MaterialConstants& k, const Particles<2>& P, std::size_t begin, std::size_t end) {
  double energy = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const double xx = P.stress[0][p], yy = P.stress[1][p], zz = P.stress[2][p], xy = P.stress[3][p];
    const double mean = (xx + yy + zz) / 3.0;
    const double dev =
        (xx - mean) * (xx - mean) + (yy - mean) * (yy - mean) + (zz - mean) * (zz - mean) + 2.0 * xy * xy;
    energy += (0.25 * dev / k.mu + 0.5 * mean * mean / k.bulk) * P.volume[p];
    if (k.pore_pressure == PorePressure::undrained)
      energy += 0.5 * P.pore_pressure[p] * P.pore_pressure[p] / k.pore_stiffness * P.volume[p];
  }
  return energy;
}

double isotropic_energy(const MaterialConstants& k, const Particles<3>& P, std::size_t begin, std::size_t end) {
  double energy = 0.0;
  for (std::size_t p = begin; p < end; ++p) {
    const Matrix3 s = stress_matrix(P, p);
    const double mean = s.trace() / 3.0;
    double density = 0.5 * mean * mean / k.bulk + 0.25 * (s - mean * Matrix3::Identity()).squaredNorm() / k.mu;
    if (k.pore_pressure == PorePressure::undrained)
      density += 0.5 * P.pore_pressure[p] * P.pore_pressure[p] / k.pore_stiffness;
    energy += density * P.volume[p];
  }
  return energy;
}

}  // namespace tailrun::mpm

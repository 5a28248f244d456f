// Isotropic linear elasticity in plane strain: what every model has before it yields. Tension positive, Pa.
#pragma once

namespace tailrun::fem {

// Effective stress (xx, yy, zz, xy).
struct PlaneStrainStress {
  double xx = 0.0;
  double yy = 0.0;
  double zz = 0.0;
  double xy = 0.0;
};

// K = 2/3 G (1 + nu)/(1 - 2 nu): the three-dimensional relation.
inline double bulk_modulus(double shear_modulus, double poisson) {
  return shear_modulus * 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson));
}

// Stress after a strain increment (engineering shear), eps_zz = 0.
inline PlaneStrainStress elastic_stress(const PlaneStrainStress& stress, double G, double poisson, double eps_xx,
                                        double eps_yy, double gamma_xy) {
  const double lame = 2.0 * G * poisson / (1.0 - 2.0 * poisson);
  const double pressure = lame * (eps_xx + eps_yy);
  return {stress.xx + pressure + 2.0 * G * eps_xx, stress.yy + pressure + 2.0 * G * eps_yy, stress.zz + pressure,
          stress.xy + G * gamma_xy};
}

}  // namespace tailrun::fem

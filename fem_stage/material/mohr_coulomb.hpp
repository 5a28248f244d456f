// Elastic, perfectly plastic Mohr-Coulomb with tension cut-off in plane strain; s_zz is part of the state. The return
// to the yield surface is closed-form in principal stresses (de Borst 1987; Clausen, Damkilde & Andersen 2006): one
// plane, an edge, or a corner, whichever satisfies all conditions. Tension positive, Pa.
#pragma once

#include <limits>

#include "fem_stage/material/linear_elastic.hpp"

namespace tailrun::fem {

struct MohrCoulombParameters {
  static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  //                                     symbol   unit    default              admissible
  double shear_modulus = unset;   // G        Pa      required             > 0
  double poisson = 0.3;           // nu       1       0.3                  [0, 0.5)
  double cohesion = unset;        // c'       Pa      required             >= 0
  double friction_angle = unset;  // phi'     deg     required             [0, 60]
  double dilation_angle = 0.0;    // psi      deg     0                    [0, phi']
  double tension_cutoff = 0.0;    // sigma_t  Pa      0                    [0, c'/tan phi']
  double density = unset;         // rho      kg/m3   required             > 0
  double porosity = 0.4;          // n        1       0.4                  [0, 1)
};

// Resolved constants. Principal stresses are ordered 1 >= 2 >= 3; the planes are k s_i - s_j <= strength.
struct MohrCoulombLaw {
  MohrCoulombParameters given;
  double k = 1.0;         // (1 + sin phi)/(1 - sin phi)
  double k_psi = 1.0;     // (1 + sin psi)/(1 - sin psi)
  double strength = 0.0;  // 2 c sqrt(k)
  double cutoff = 0.0;    // largest tensile stress, never above c/tan phi
};

MohrCoulombLaw resolve(const MohrCoulombParameters& parameters);

struct MohrCoulombReturn {
  PlaneStrainStress stress;
  int planes = 0;               // active ones: 0 elastic, 1 plane, 2 edge, 3 corner
  double plastic_strain = 0.0;  // increment of the equivalent deviatoric plastic strain sqrt(2/3 e:e)
  double plastic_volume = 0.0;  // increment of the volumetric plastic strain, extension positive
};

// Stress on or inside the yield surface from an elastic trial stress, with the moduli G and poisson.
MohrCoulombReturn return_to_yield(const MohrCoulombLaw& law, double G, double poisson, const PlaneStrainStress& trial);

// Largest yield function value (Pa) of a stress: <= 0 inside.
double yield_excess(const MohrCoulombLaw& law, const PlaneStrainStress& stress);

}  // namespace tailrun::fem

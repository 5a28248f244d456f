// Elastic, perfectly plastic Mohr-Coulomb with tension cut-off in plane strain; s_zz is part of the state. The return
// to the yield surface is closed-form in principal stresses (de Borst 1987; Clausen, Damkilde & Andersen 2006): one
// plane, an edge, or a corner, whichever satisfies all conditions. Tension positive, Pa.
#pragma once

#include "fem_stage/material/elastic_plastic_points.hpp"
#include "fem_stage/material/material_keys.hpp"

namespace tailrun::fem {

struct MohrCoulombLaw;

struct MohrCoulombParameters {
  static constexpr std::string_view model_name = "mohr_coulomb";
  using Points = ElasticPlasticPoints<MohrCoulombLaw>;

  double shear_modulus = unset;   // G
  double poisson = 0.3;           // nu
  double cohesion = unset;        // c'
  double friction_angle = unset;  // phi'
  double dilation_angle = 0.0;    // psi
  double tension_cutoff = 0.0;    // sigma_t; c'/tan phi' where it is more
  double density = unset;         // rho of the saturated soil
  double pore_share = 0.4;        // n

  static MohrCoulombParameters read(const CaseNode& node);
  double porosity() const { return pore_share; }
};

struct MohrCoulombReturn {
  PlaneStrainStress stress;
  int planes = 0;               // active ones: 0 elastic, 1 plane, 2 edge, 3 corner
  double plastic_strain = 0.0;  // increment of the equivalent deviatoric plastic strain sqrt(2/3 e:e)
  double plastic_volume = 0.0;  // increment of the volumetric plastic strain, extension positive
};

// Resolved constants. Principal stresses are ordered 1 >= 2 >= 3; the planes are k s_i - s_j <= strength.
struct MohrCoulombLaw {
  static constexpr bool has_yield = true;
  double shear_modulus = 0.0;
  double poisson = 0.3;
  double k = 1.0;         // (1 + sin phi)/(1 - sin phi)
  double k_psi = 1.0;     // (1 + sin psi)/(1 - sin psi)
  double strength = 0.0;  // 2 c sqrt(k)
  double cutoff = 0.0;    // largest tensile stress, never above c/tan phi

  MohrCoulombReturn to_yield(const PlaneStrainStress& trial) const;
  void set_post_shaking(bool) {}
};

MohrCoulombLaw resolve(const MohrCoulombParameters& parameters);

// Stress on or inside the yield surface from an elastic trial stress, with the moduli G and poisson.
MohrCoulombReturn return_to_yield(const MohrCoulombLaw& law, double G, double poisson, const PlaneStrainStress& trial);

// Largest yield function value (Pa) of a stress: <= 0 inside.
double yield_excess(const MohrCoulombLaw& law, const PlaneStrainStress& stress);

}  // namespace tailrun::fem

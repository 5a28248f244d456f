// What a particle can be made of: parameters as the case file gives them, and the constants that the stress update of a
// run of particles needs, worked out once. Both hold what several laws share; what one law alone knows is in `own`.
//
// The rest of the stage asks for properties (phi_zero, flows, explicit_viscosity, MaterialLaw::moves ...), never for
// a model by its name.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mpm_stage/material/material_law.hpp"
#include "mpm_stage/material/own_numbers.hpp"

namespace tailrun::mpm {

enum class PorePressure { total, frozen, undrained };
enum class SofteningShape { linear, exponential };

// Fall of strength with deviatoric plastic strain, from 1 at 0 to `ratio` of the peak. Strain localises in a band about
// one cell thick, so the strain over which it falls is scaled by reference_length / cell size: then the energy spent
// per unit area of a shear band does not depend on the cell (crack-band idea, Bazant & Oh 1983).
struct Softening {
  bool active = false;
  SofteningShape shape = SofteningShape::linear;
  double start_strain = 0.0;  // 1, strength stays at its peak up to here
  double end_strain = 1.0;    // 1, residual from here on (linear), or the e-folding strain after start (exponential)
  double reference_length = 0.0;    // m, 0: not scaled
  double cohesion_ratio = 1.0;      // residual / peak
  double residual_friction = -1.0;  // degrees; negative: friction does not soften
};

// Strength times (1 + (viscosity * rate^exponent) / c): Bingham for exponent 1, Herschel & Bulkley (1926) otherwise.
struct RateLaw {
  double consistency = 0.0;  // Pa s^n; for newtonian_fluid the dynamic viscosity
  double exponent = 1.0;     // 1, n
};

struct Material {
  std::string name;
  const MaterialLaw* law = &law_named("linear_elastic");
  double density = 0.0;                  // kg/m3; needed where particles are made here, and by newtonian_fluid
  double youngs_modulus = 0.0;           // Pa
  double poisson_ratio = 0.0;            // 1
  double bulk_modulus = 0.0;             // Pa, of fluids
  double cohesion = 0.0;                 // Pa
  bool cohesion_from_particles = false;  // residual_strength of the particles file
  double cohesion_factor = 1.0;          // 1, on a cohesion that came from the particles
  std::vector<double> cohesion_table;    // Pa, (n, 2): sigma'_v0, cohesion; empty: not used
  double cohesion_ratio = 0.0;           // 1, cohesion / sigma'_v0; 0: not used
  double minimum_cohesion = 0.0;         // Pa, for tables and ratios
  double friction_angle = 0.0;           // degrees
  double dilation_angle = 0.0;           // degrees
  double tension_cutoff = -1.0;          // Pa, largest principal tension; negative: none
  bool average_volumetric_strain = true;
  Softening softening;
  RateLaw rate;
  PorePressure pore_pressure = PorePressure::total;
  double pore_stiffness = 0.0;  // Pa, K_f / n, for undrained
  OwnNumbers own;
};

// Constants of the stress update, in the letters of the formulae, and what the step asks of a material.
struct MaterialConstants {
  // The law's loops, chosen at set-up: a run of particles costs one call, a particle none.
  LawLoops<2> plane;
  LawLoops<3> solid;

  double lambda = 0.0, mu = 0.0, bulk = 0.0;  // Pa, Lame constants and K
  double tension = -1.0;                      // Pa
  double reference_density = 0.0;             // kg/m3
  bool softens = false, exponential = false;
  double soften_start = 0.0, soften_scale = 1.0;  // 1, after scaling with the cell size
  double cohesion_ratio = 1.0;
  double consistency = 0.0, exponent = 1.0;  // Pa s^n and 1, of strength that grows with the rate of shear
  PorePressure pore_pressure = PorePressure::total;
  double pore_stiffness = 0.0;
  // m3/kg, of soil that yields. Soil that comes apart carries no stress but would go on counting the opening voids as
  // its own volume; its density would go to nothing and its wave speed would take the time step along.
  double largest_specific_volume = 1e300;
  OwnNumbers own;

  // Properties.
  bool averaged = true;   // its volumetric strain, over neighbouring cells
  bool flows = false;     // as MaterialLaw::flows
  bool phi_zero = false;  // its particles' strength is all the shear that it carries, whatever the mean stress
  double explicit_viscosity = 0.0;  // Pa s, of viscous stress that limits the time step (h^2 rho / eta); 0: none

  // Pa, of a longitudinal wave: K + 4 G / 3 and the stiffness of the pore fluid where it counts.
  double wave_modulus() const {
    return bulk + 4.0 / 3.0 * mu + (pore_pressure == PorePressure::undrained ? pore_stiffness : 0.0);
  }
};

// `cell_size` (m) regularises softening. Plane strain and 3-D have the same constants.
MaterialConstants constants_of(const Material& material, double cell_size);

}  // namespace tailrun::mpm

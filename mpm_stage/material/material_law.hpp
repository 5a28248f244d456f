// What one constitutive model (a law) is to the rest of the stage. Each law is one file of this folder, named after it:
// the physics and its source, its keys of mpm.json, its constants, its loops over particles, and at the end one object
// of this type, which material_list.cpp names.
#pragma once

#include <cstddef>
#include <string_view>

namespace tailrun {
class CaseNode;
}

namespace tailrun::mpm {

template <int Dim>
struct Particles;
struct Material;
struct MaterialConstants;
template <class Real>
struct PrincipalOf;

// The loops of a law over the particles begin .. end of one material.
template <int Dim>
struct LawLoops {
  // New stress, volume and plastic strain; arguments as update_stress (stress_update.hpp) takes them. Returns what was
  // dissipated, J. Pore pressure is not its concern.
  double (*update)(const MaterialConstants& k, Particles<Dim>& P, std::size_t begin, std::size_t end,
                   const double* trace, double dt) = nullptr;
  // Recoverable energy, J.
  double (*energy)(const MaterialConstants& k, const Particles<Dim>& P, std::size_t begin, std::size_t end) = nullptr;
  // Recoverable energy of particle p, J, were its volumetric increment `trace`. Null where the pressure follows its
  // elastic modulus whatever the volume.
  double (*energy_after)(const MaterialConstants& k, const Particles<Dim>& P, std::size_t p, double trace) = nullptr;
};

struct MaterialLaw {
  const char* name;  // its word for "model" in mpm.json

  // Properties that the scene and the output ask for.
  bool rigid = false;          // takes no part: its particles are left out, terrain stands in their place
  bool moves = true;           // the front, the followed points and the criterion of rest look at it
  bool flows = false;          // phi = 0 soil and fluids: beside other soil they have a velocity field of their own
  bool keeps_surface = false;  // its surface lasts, and the stress along it: velocities may be continued beyond it
  // Its pressure follows from its volume alone: particles remember the one that they have at no pressure, which is
  // chosen so that they start with the stress that they are given.
  bool keeps_rest_volume = false;
  // "residual_strength"/"factor" of the case file scales its cohesion.
  bool residual_strength = false;

  // Reads the keys of `node`, an entry of "materials"; "model" has been read.
  void (*read)(const CaseNode& node, Material& material);
  // Completes `k`, which has the density, averaging and pore pressure of the material.
  void (*set_constants)(const Material& material, double cell_size, MaterialConstants& k);
  // Principal stresses (Pa, s1 >= s2 >= s3) that the trial returns to at the cohesion given (Pa), with nothing softened
  // and the cut-off applied: what the loops do with a particle, for tests. Null where nothing yields.
  PrincipalOf<double> (*returned)(const MaterialConstants& k, double cohesion,
                                  const PrincipalOf<double>& trial) = nullptr;
};

// The law that "model" names. Throws InputError, with the nearest name, where there is none (material_list.cpp).
const MaterialLaw& law_named(std::string_view name);

}  // namespace tailrun::mpm

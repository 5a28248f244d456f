// "residual_strength" of a material in fem.json: the strength that its soil keeps once it has liquefied, by the
// relations of the hand-over, and when it counts as liquefied (the floor itself: material/residual_floor.hpp); and how
// its softening follows the size of the elements.
#pragma once

#include <limits>
#include <memory>

namespace tailrun {
class CaseNode;
struct StrengthLaw;
}  // namespace tailrun

namespace tailrun::fem {

struct LiquefiedStrength {
  std::shared_ptr<const StrengthLaw> law;
  // Liquefied for good once either is passed; infinity: never by that.
  double pore_pressure_ratio = 0.7;                               // r_u
  double shear_strain = std::numeric_limits<double>::infinity();  // engineering, in the plane
  double mobilisation_strain = 0.05;  // engineering shear strain at which the floor by itself carries all of s_R
};

// "softening" of a material: material/softening_scale.hpp.
struct Softening {
  double reference_height = 0.0;    // m, h_ref; 0: off
  double from_shear_strain = 0.01;  // engineering, in the plane: where the scaling begins, beyond the peak
};

// Throws InputError.
Softening read_softening(const CaseNode& node);

// The keys of read_strength_law, "mobilisation_strain" and "trigger". Throws InputError.
LiquefiedStrength read_liquefied_strength(const CaseNode& node);

}  // namespace tailrun::fem

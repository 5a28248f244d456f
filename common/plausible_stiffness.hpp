// Stiffness and strength of a material: too small to carry its own weight, or larger than any matter has, most often
// because their unit is another one.
#pragma once

#include "common/plausible_material.hpp"

namespace tailrun {

// Pa; each a warning, for a run with it is possible. Nothing without gravity.
//   youngs_modulus, shear_modulus
//     over 5e11          steel has 2e11: Pa were multiplied once too often
//     over 5e10          of soil or rock lighter than 2300 kg/m3: what is as stiff is as dense as granite or metal
//     over 1e10          of soil that yields (cohesion, friction_angle) and is lighter than 2200 kg/m3: rock as light
//                        (chalk, tuff) has less
//   bulk_modulus
//     over 1e11          water has 2.2e9, in the pores of dense soil 1e10
//   cohesion             over a fifth of Young's modulus: it would yield at a strain of a fifth, which is that of
//                        rubber; soils have a hundredth and less, rock a two-hundredth
//   strength             (of PM4Silt, S_u) over 1e6: hard clay has 5e5
void check_too_large(const CaseNode& material, const MaterialSetting& setting);

// Against the weight of `setting.height` of this soil:
//   cohesion, strength   above 0 and under both 100 Pa and a thousandth of the weight: kPa, where it is all the
//   strength
//                        (neither friction nor "rate" beside it)
//   shear_modulus, youngs_modulus
//                        under half of the weight, which it would not carry without flattening: kPa or MPa
// Nothing without gravity, or with a height of 0 (not known).
void check_against_weight(const CaseNode& material, const MaterialSetting& setting);

// Pa, of the pore water: under 1e7 even with air in it, 2.2e9 without: kPa or MPa. Over 1e11: multiplied once too
// often.
void check_water_stiffness(const CaseNode& node, const std::string& key, double bulk_modulus, double gravity);

}  // namespace tailrun

// Numbers of a material that no soil has, most often because their unit is another one. What nothing sensible can
// follow from is an error, what is only unlikely a warning (common/warnings.hpp). The same keys mean the same in
// fem.json and mpm.json, so both programs ask here.
#pragma once

#include "common/case_file.hpp"

namespace tailrun {

// What the material lies in. Without gravity nothing is checked: such scenes are patches and waves in units of their
// own.
struct MaterialSetting {
  double gravity = 9.81;          // m/s2, its size
  double height = 10.0;           // m, of the soil: its own weight is what strength and stiffness are compared with;
                                  // 0 = not known yet
  double water_density = 1000.0;  // kg/m3
  bool has_water = false;
  bool flows_by_rate = false;  // its strength grows with the rate of shear
};

// One entry of "materials". Keys, as far as they are there, and their reasons:
//   density          under 30: g/cm3 or kN/m3 (error). Under water's, where there is water, the soil would float and
//   its
//                    effective stress be a tension; beyond 4000 no soil or rock of a dam is
//   stiffness, strengths
//                    common/plausible_stiffness.hpp
//   angles           common/plausible_angles.hpp
//   void ratios, porosity, relative density
//                    common/plausible_voids.hpp; these are what is judged without gravity, too
//   strength_ratio   (S_u over sigma'_v0) above 5, which overconsolidated clay does not reach: a percentage (error)
//   atmospheric_pressure
//                    outside of 5e4 to 2e5: kPa or another unit (warning)
//   G0               a coefficient of 100 to 2000 in PM4: above 5000 it is taken for a modulus
void check_material(const CaseNode& material, const MaterialSetting& setting);

// "factor" on a strength: above 10 it is a percentage (error).
void check_factor(const CaseNode& node, const std::string& key, double factor);

// A residual strength of liquefied soil, Pa (soils have 1 to 50 kPa): above 0 and under 100 it is kPa; over 1e6, which
// hard clay does not reach, it was multiplied once too often.
void check_residual_strength(const CaseNode& node, const std::string& key, double strength);

// A shear stress or strength over sigma'_v0 ("ratio", "minimum_ratio", "csr", "strength_ratio"): a fraction. Above
// `most` it is a percentage (error). 1 is more than a friction angle of 45 degrees gives normally consolidated soil.
void check_fraction(const CaseNode& node, const std::string& key, double most = 1.0);

// A stress in the ground, Pa: above 0 and under 1e3 it is kPa, for that is the stress under less than a tenth of a
// metre of soil (warning).
void check_ground_stress(const CaseNode& node, const std::string& key);

// "percentile" (%) above 0 and under 1: a fraction, 0.33 for 33 (warning).
void check_percentile(const CaseNode& node, const std::string& key);

// "fines_content" (%), likewise.
void check_fines_content(const CaseNode& node, const std::string& key);

// "cone_resistance" in Pa: soils that flow have q_c1 of 0.2 to 10 MPa. Above 0 and under 1e4 it is in MPa or kPa
// (error), since the strength would be that of no resistance at all; under 1e5 a warning.
void check_cone_stress(const CaseNode& node, const std::string& key);

// "cone_resistance" without unit, normalised by p_A = 0.1 MPa: above 0 and under 10 it is rather one in MPa (warning).
void check_normalised_cone(const CaseNode& node, const std::string& key, const char* symbol);

}  // namespace tailrun

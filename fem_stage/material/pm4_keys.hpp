// Keys that PM4Sand and PM4Silt have in common; their defaults are those of each model's parameters.
#pragma once

#include "fem_stage/material/material_keys.hpp"
#include "fem_stage/material/pm4_law.hpp"

namespace tailrun::fem {

inline Pm4Compatibility read_compatibility(const CaseNode& node) {
  const std::string word = node.choice_or("compatibility", {"improved", "opensees"}, "improved");
  return word == "opensees" ? Pm4Compatibility::opensees : Pm4Compatibility::improved;
}

inline Pm4BoundingClip read_bounding_clip(const CaseNode& node, Pm4BoundingClip otherwise) {
  const char* name = otherwise == Pm4BoundingClip::always ? "always" : "simple_shear";
  return node.choice_or("bounding_clip", {"always", "simple_shear"}, name) == "always" ? Pm4BoundingClip::always
                                                                                       : Pm4BoundingClip::simple_shear;
}

// `opensees_clip`: what OpenSees does for this material, hence the default of the compatible mode.
template <class Parameters>
void read_pm4_keys(const CaseNode& node, Pm4BoundingClip opensees_clip, Parameters& p) {
  p.contraction_rate = node.number("hpo", "1", Range::positive());
  p.density = node.number("density", "kg/m3", Range::positive());
  read_number(node, "atmospheric_pressure", "Pa", Range::positive(), p.atmospheric_pressure);
  read_optional(node, "h0", "1", Range::positive(), p.hardening_ratio);
  read_optional(node, "A_do", "1", Range::positive(), p.A_do);
  read_optional(node, "z_max", "1", Range::positive(), p.z_max);
  read_optional(node, "C_epsilon", "1", Range::positive(), p.C_epsilon);
  read_optional(node, "C_Kaf", "1", Range::non_negative(), p.C_Kaf);
  read_number(node, "c_z", "1", Range::non_negative(), p.c_z);
  read_number(node, "n_d", "1", Range::non_negative(), p.n_d);
  read_number(node, "phi_cv", "deg", Range::open(0.0, 60.0), p.phi_cv);
  read_number(node, "poisson_ratio", "1", Range::between(0.0, 0.4999), p.poisson);
  read_number(node, "C_GD", "1", {1.0}, p.C_GD);
  read_number(node, "m", "1", {0.0, 0.1, true, false}, p.m);
  p.compatibility = read_compatibility(node);
  p.bounding_clip =
      read_bounding_clip(node, p.compatibility == Pm4Compatibility::opensees ? opensees_clip : Pm4BoundingClip::always);
}

}  // namespace tailrun::fem

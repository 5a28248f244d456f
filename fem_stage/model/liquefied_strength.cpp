#include "fem_stage/model/liquefied_strength.hpp"

#include <fmt/core.h>

#include "common/residual_strength/strength_law.hpp"

namespace tailrun::fem {

LiquefiedStrength read_liquefied_strength(const CaseNode& node) {
  LiquefiedStrength out;
  out.law = std::make_shared<const StrengthLaw>(read_strength_law(node));
  out.mobilisation_strain = node.number_or("mobilisation_strain", "1", {1e-4, 1.0}, out.mobilisation_strain);
  const CaseNode trigger = node.object_or_empty("trigger");
  out.pore_pressure_ratio =
      trigger.number_or("excess_pore_pressure_ratio", "1", Range::positive(), out.pore_pressure_ratio);
  // r_u seldom passes 1.2: a bound above 2 is a percentage, and no soil would ever be beyond it.
  if (out.pore_pressure_ratio > 2.0)
    trigger.warn("excess_pore_pressure_ratio",
                 fmt::format("{:g}; r_u is a ratio, {:g} % are {:g}", out.pore_pressure_ratio, out.pore_pressure_ratio,
                             0.01 * out.pore_pressure_ratio));
  if (const auto strain = trigger.number_if("shear_strain", "1", Range::positive())) out.shear_strain = *strain;
  return out;
}

Softening read_softening(const CaseNode& node) {
  Softening out;
  out.reference_height = node.number_or("reference_height", "m", Range::non_negative(), out.reference_height);
  out.from_shear_strain = node.number_or("from_shear_strain", "1", Range::positive(), out.from_shear_strain);
  return out;
}

}  // namespace tailrun::fem

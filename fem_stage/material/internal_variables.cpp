#include "fem_stage/material/internal_variables.hpp"

#include "common/error.hpp"
#include "fem_stage/material/material_group.hpp"

namespace tailrun::fem {

const std::vector<std::string>& internal_variable_name_list() {
  static const std::vector<std::string> names{
      "fabric",          "fabric_cumulative", "back_stress_ratio",         "stress_ratio", "bounding_ratio",
      "state_parameter", "plastic_strain",    "plastic_volumetric_strain", "substeps"};
  return names;
}

template <class Law>
double Pm4Group<Law>::internal_variable(std::size_t i, InternalVariable which) const {
  const Pm4State& state = committed_[i];
  const Pm4Variables& v = state.v;
  const bool plastic = stage_[i].plastic != 0.0;
  const double p_star = std::max(v.p, constants_[i].p_min);
  switch (which) {
    case InternalVariable::fabric:
      return sqrt_half * norm(v.z);
    case InternalVariable::fabric_cumulative:
      return v.z_cum;
    case InternalVariable::back_stress_ratio:
      return sqrt_two * norm(v.alpha);
    case InternalVariable::stress_ratio:
      return p_star > 0.0 ? sqrt_two * norm(v.s) / p_star : 0.0;
    case InternalVariable::bounding_ratio:
    case InternalVariable::state_parameter: {
      if (!plastic) return no_such_variable;
      const Law& law = *law_[i];
      const Pm4Surfaces surfaces =
          law.surfaces(constants_[i], p_star, law.index0 + law.index_slope * state.volumetric_strain);
      return which == InternalVariable::bounding_ratio ? surfaces.M_b : surfaces.xi;
    }
    case InternalVariable::substeps:
      return static_cast<double>(substeps_[i]);
    default:
      return no_such_variable;
  }
}

template double Pm4Group<Pm4SandLaw>::internal_variable(std::size_t, InternalVariable) const;
template double Pm4Group<Pm4SiltLaw>::internal_variable(std::size_t, InternalVariable) const;

double ElasticPlasticGroup::internal_variable(std::size_t i, InternalVariable which) const {
  if (which == InternalVariable::plastic_strain) return committed_[i].plastic_strain;
  if (which == InternalVariable::plastic_volumetric_strain) return committed_[i].plastic_volume;
  return no_such_variable;
}

}  // namespace tailrun::fem

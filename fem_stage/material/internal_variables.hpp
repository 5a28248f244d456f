// The internal variables that output files can carry, by name.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace tailrun::fem {

enum class InternalVariable : std::size_t {
  fabric,                     // sqrt(z:z/2)
  fabric_cumulative,          // z_cum
  back_stress_ratio,          // sqrt(2 alpha:alpha), comparable with q/p
  stress_ratio,               // q/max(p, p_min)
  bounding_ratio,             // M_b
  state_parameter,            // xi_R (PM4Sand), xi/lambda (PM4Silt)
  plastic_strain,             // equivalent deviatoric plastic strain (Mohr-Coulomb)
  plastic_volumetric_strain,  // extension positive (Mohr-Coulomb)
  substeps                    // of the last update that changed the point
};

inline constexpr double no_such_variable = std::numeric_limits<double>::quiet_NaN();

const std::vector<std::string>& internal_variable_name_list();

}  // namespace tailrun::fem

// Angles in degrees that look like radians. Every case file of the three programs asks here for the angles of soil, so
// that a key that is an angle is one line in one table.
//
// Angles of places (rotation, angle, downstream_slope) are not judged: slopes of one degree are common under water.
#pragma once

#include <string>

#include "common/case_file.hpp"

namespace tailrun {

// Each angle of soil that `node` has, degrees, with its reason (a warning):
//   friction_angle, residual_friction_angle, phi_cv, phi_b_max
//                    above 0 and under 1.6, a right angle in radians: no soil has so little friction
//   dilation_angle   above 0.1 and up to 0.4, which is 5.7 to 23 degrees in radians. 0.1 and less is what programs
//                    that take no 0 are given for none, and 1 degree what loose sand has
void check_angles(const CaseNode& node);

// The same of one friction angle, degrees, that is known otherwise.
void check_angle(const CaseNode& node, const std::string& key, double degrees);

}  // namespace tailrun

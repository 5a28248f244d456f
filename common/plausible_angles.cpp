#include "common/plausible_angles.hpp"

#include <fmt/core.h>

#include <numbers>

namespace tailrun {
namespace {

struct AngleKey {
  const char* key;
  double above, below;  // degrees: between them it is rather in radians
};

constexpr double right_angle = 1.6;  // radians
constexpr AngleKey angle_keys[] = {{"friction_angle", 0.0, right_angle},
                                   {"residual_friction_angle", 0.0, right_angle},
                                   {"phi_cv", 0.0, right_angle},
                                   {"phi_b_max", 0.0, right_angle},
                                   {"dilation_angle", 0.1, 0.4}};

void warn_between(const CaseNode& node, const AngleKey& angle, double degrees) {
  if (degrees > angle.above && degrees < angle.below)
    node.warn(angle.key, fmt::format("{0:g} degrees; {0:g} radians would be {1:.3g} degrees", degrees,
                                     degrees * 180.0 / std::numbers::pi));
}

}  // namespace

void check_angles(const CaseNode& node) {
  for (const AngleKey& angle : angle_keys)
    if (const auto degrees = node.peek(angle.key)) warn_between(node, angle, *degrees);
}

void check_angle(const CaseNode& node, const std::string& key, double degrees) {
  warn_between(node, {key.c_str(), 0.0, right_angle}, degrees);
}

}  // namespace tailrun

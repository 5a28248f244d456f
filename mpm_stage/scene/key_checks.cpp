#include "mpm_stage/scene/key_checks.hpp"

#include <fmt/core.h>

#include <cmath>

#include "common/plain_names.hpp"

namespace tailrun::mpm {

void require_column_word(const CaseNode& node, const std::string& key, const std::string& name) {
  const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (!name.empty() && name.find_first_not_of(allowed) == std::string::npos) return;
  node.fail(key, fmt::format("{} becomes part of a column's name: letters, digits, _ and - only", shown_name(name)));
}

void refuse_with_other_choice(const CaseNode& node, const std::string& misplaced, const std::string& key,
                              const std::string& found, const std::string& needs) {
  if (!node.has(misplaced)) return;
  node.fail(misplaced, fmt::format("goes with {} {}, but '{}' is '{}'{}", key, needs, key, found,
                                   node.has(key) ? "" : " unless it is given"));
}

void check_friction(const CaseNode& node, const std::string& key, double friction, const std::string& on) {
  constexpr double degrees_from = 10.0;  // a ground that holds what lies on it has 1
  if (friction > degrees_from && friction < 90.0)
    node.warn(key,
              fmt::format("{:g} on {} is a coefficient, not an angle; were it meant in degrees, it would be {:.3g}",
                          friction, on, std::tan(friction * M_PI / 180.0)));
}

}  // namespace tailrun::mpm

// Ponds of a scene: what is given of them, and what they have come to. What they do to the soil is in ponded_water.hpp.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace tailrun::mpm {

// y is up.
struct Pond {
  static constexpr double endless = std::numeric_limits<double>::infinity();
  std::string name;
  std::array<double, 3> low{-endless, -endless, -endless}, high{endless, endless, endless};  // m, the range; y: no end
  std::vector<double> time, level;  // s, m: linear between them, constant before and after
  double unit_weight = 9810.0;      // N/m3

  double level_at(double t) const;
};

// What a pond has come to.
struct PondState {
  double level = 0.0;             // m
  double mapped_level = 0.0;      // m, for which the shares were made
  double escaped = -1.0;          // s, since when its water could leave its range; negative: it could not
  std::array<double, 3> place{};  // m, where
};

}  // namespace tailrun::mpm

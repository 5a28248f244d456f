// Still water outside of the soil, as the files of the chain carry it.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace tailrun {

// As the finite elements have it: water against named lines of the mesh.
struct PondedLines {
  double level = 0.0;              // m
  std::vector<std::string> lines;  // names of lines of the mesh
};

// As the particles get it: water wherever there is no soil below the level, between two places.
struct PondedReach {
  std::string name;
  double level = 0.0;              // m
  std::array<double, 2> extent{};  // m, from x to x
  std::array<bool, 2> endless{};   // whether the water goes on beyond that
  double density = 1000.0;         // kg/m3
};

}  // namespace tailrun

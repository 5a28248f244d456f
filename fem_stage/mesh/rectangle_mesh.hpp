// A rectangle of rows and columns of quadrilaterals, written as a .msh file: columns, bars and single elements need no
// geometry file. Its outline has the lines bottom, right, top and left.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace tailrun::fem {

struct RectangleLayer {
  std::string region;
  double height = 0.0;  // m
  int rows = 1;
};

struct RectangleMesh {
  std::array<double, 2> origin{};  // m, lower left corner
  double width = 0.0;              // m
  int columns = 1;
  std::vector<RectangleLayer> layers;  // from the bottom up
  // Inner nodes are moved by up to this share of the spacing along x and y, pseudo-randomly and always in the same way;
  // nodes between two layers only along x.
  double distortion = 0.0;
};

// MSH 2.2 text with full precision. Throws ComputationError when it cannot be written.
void write_rectangle_mesh(const RectangleMesh& rectangle, const std::filesystem::path& path);

}  // namespace tailrun::fem

// The finite element mesh: nodes, quadrilaterals with regions, and named lines. Structure of arrays.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tailrun::fem {

struct Mesh {
  std::vector<double> position;                                           // m, (N, 2)
  std::vector<std::int64_t> quads;                                        // (M, 4), counter-clockwise
  std::vector<std::int32_t> region;                                       // (M), index into region_names
  std::vector<std::string> region_names;                                  // gmsh physical surfaces
  std::map<std::string, std::vector<std::array<std::int64_t, 2>>> lines;  // gmsh physical curves: edges

  std::size_t nodes() const { return position.size() / 2; }
  std::size_t elements() const { return region.size(); }
  double x(std::size_t node) const { return position[2 * node]; }
  double y(std::size_t node) const { return position[2 * node + 1]; }
  // Nodes of a named line, each once, ascending. Throws InputError when there is no such line.
  std::vector<std::int64_t> nodes_of_line(const std::string& name) const;
  std::array<double, 2> centre(std::size_t element) const;
  // Index of the nearest node, or element centre, to (x, y).
  std::size_t nearest_node(double px, double py) const;
  std::size_t nearest_element(double px, double py) const;
};

// Turns clockwise quadrilaterals round, and throws InputError (exit 1) for what no analysis can use: no elements,
// degenerate or non-convex elements, the same element twice, nodes in no element, edges shared by more than two
// elements, and boundary edges that belong to no named line (a hole: a surface that was left out of the physical
// groups). `source` names the mesh file.
void check_mesh(Mesh& mesh, const std::string& source);

// Smallest sine of a corner angle, signed by the orientation of the corner: 1 for a rectangle, <= 0 when inverted.
double scaled_jacobian(const double corners[8]);
// For every element of the mesh displaced by `displacement` (m, (N, 2); empty for none).
std::vector<double> scaled_jacobians(const Mesh& mesh, const std::vector<double>& displacement);

// The upper outline of the mesh: highest boundary elevation (m) above each of the given abscissae. Throws InputError
// for an abscissa outside the mesh.
double ground_elevation(const Mesh& mesh, double x);

}  // namespace tailrun::fem

// Loads on lines and points as consistent nodal forces, and water standing on a line of the ground.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "fem_stage/boundary/time_history.hpp"
#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

struct NodalForce {
  std::int64_t node;
  double x, y;  // N
};

struct NodalLoad {
  std::vector<NodalForce> forces;
  TimeHistory history;
  bool in_geostatic = true, in_shake = true;
};

// An edge of the model's outline, with what lies behind it.
struct BoundaryEdge {
  std::int64_t a, b;
  double length, thickness;      // m
  std::array<double, 2> normal;  // unit, outward
};

// The edges of a named line. Throws InputError (starting with `where`, a place in the case file) when there is no such
// line or when it runs inside the model, where no outside is defined. `thickness` m, one per element.
std::vector<BoundaryEdge> boundary_edges(const Mesh& mesh, std::span<const double> thickness, const std::string& line,
                                         const std::string& where);

// Forces of a traction (Pa, along x and y) and a pressure (Pa, against the outward normal), both constant on the line:
// integral of N_a t dS, one entry per node of each edge.
std::vector<NodalForce> line_forces(std::span<const BoundaryEdge> edges, std::array<double, 2> traction,
                                    double pressure);

// Pressure of water with its surface at `level` (m) and unit weight `weight` (N/m3): integral of N_a w (level - y) dS
// over the wetted part of each edge, against the outward normal.
std::vector<NodalForce> pond_forces(const Mesh& mesh, std::span<const BoundaryEdge> edges, double level, double weight);

// Adds factor(time) times the load to `force` (N, (N, 2)).
void add_load(const NodalLoad& load, double time, std::span<double> force);

}  // namespace tailrun::fem

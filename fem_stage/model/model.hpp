// The discretised problem: mesh, elements, soil and water properties, freedoms, loads that never change. Built once
// from a FemCase; the State is what evolves.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem_stage/boundary/freedoms.hpp"
#include "fem_stage/boundary/nodal_loads.hpp"
#include "fem_stage/element/sspquadup.hpp"
#include "fem_stage/material/material_points.hpp"
#include "fem_stage/mesh/mesh.hpp"
#include "fem_stage/model/fem_case.hpp"

namespace tailrun::fem {

struct Model {
  const FemCase* options = nullptr;
  Mesh mesh;
  SspQuadUp elements;             // undeformed
  std::vector<double> thickness;  // m, (M)
  std::vector<double> density;    // kg/m3, (M), total
  std::vector<double> porosity;   // 1, (M)
  std::vector<double> bulk_initial,
      shear_initial;  // Pa, (M): elastic moduli at the reference pressure (G0 p_A for PM4)
  std::vector<double> permeability_x, permeability_y;  // m4/(N s), (M): k / (rho_f g)
  std::vector<double> stabilisation;                   // m4/N, (M): alpha of the pressure stabilisation
  std::vector<double> nodal_mass;                      // kg, (N), lumped
  std::vector<double> storage;   // 1/Pa, (M): n / K of the water, soft above the phreatic line where the case says so
  std::vector<char> soft_fluid;  // (M): water above the phreatic line that can be pushed up (soft_fluid.hpp)
  std::vector<char> pressure_fixed;   // (N): p held: on and above the phreatic line, drained lines, under a pond
  std::vector<char> dry_at_rest;      // (N): p = 0 in the geostatic stage only, where a soft fluid is
  std::vector<double> held_pressure;  // Pa, (N): the value where it is held, 0 elsewhere
  std::vector<NodalLoad> loads;       // beside gravity: lines, points, ponded water
  std::vector<double> base_area;      // m2, per node of base_nodes: tributary area
  std::vector<std::int64_t> base_nodes;
  std::vector<double> nodal_thickness;  // m, (N): of the elements around, weighted by their mass
  // N/m, scale of forces per thickness: 2-norm of the nodal weights, or of the loads if that is larger, each over its
  // node's thickness. A free-field column counts as a slice does, however thick it is.
  double weight = 0.0;

  // (node -> elements) in compressed rows, so that nodal sums are gathered in a fixed order by any thread
  std::vector<int> adjacency_start, adjacency;  // entries are 4 * element + local node

  // Pa: the part of an element's mean pore pressure that total stress feels.
  double pressure_in_stress(std::size_t e, double pressure) const {
    return soft_fluid[e] && pressure < 0.0 ? 0.0 : pressure;
  }
  std::size_t nodes() const { return mesh.nodes(); }
  std::size_t count() const { return mesh.elements(); }
};

// What evolves. Displacement counts from the start of shaking; velocities and accelerations are absolute for a
// compliant base and relative to the base for a rigid one.
struct State {
  double time = 0.0;
  std::vector<double> displacement, velocity, acceleration;  // m, m/s, m/s2, (N, 2)
  std::vector<double> pressure, pressure_rate;               // Pa, Pa/s, (N)
  std::vector<double> stress;                                // Pa, (M, 4), effective, committed
  std::vector<double> hourglass_force;                       // N, (M, 2), committed: G F q summed over increments
  std::vector<double> held_force;                            // N, (N, 2): reactions of released freedoms, constant
  // The geostatic state that results refer to.
  std::vector<double> initial_stress;           // Pa, (M, 4)
  std::vector<double> initial_pressure;         // Pa, (N)
  std::vector<double> max_pore_pressure_ratio;  // 1, (M)
  // Only with large displacement, and only once it has begun: what a restart needs.
  std::vector<double> rotation;                // rad, (M): of the frames that the material's stress lives in
  std::vector<double> turned_hourglass_force;  // N, (M, 2): hourglass forces turned with the element
  // Only where the case has a residual strength, and only once shaking has begun: its floor, see residual_floor.hpp.
  std::vector<double> floor_stress;  // Pa, (M, 2), in the frame that the material's stress lives in
  std::vector<double> liquefied;     // 1, (M): 1 for good once the element has liquefied
  std::vector<double> softening;     // 1, (M): 1 for good where softening is scaled, see softening_scale.hpp; likewise
  double rigid_displacement = 0.0;   // m, along x: of a rigid base since the start of shaking
};

// Reads or makes the mesh and everything that depends on it. `mesh_file` overrides the case's. Throws InputError:
// regions of the mesh that the case does not describe (and the other way round), lines that do not exist.
Model build_model(const FemCase& options, const std::filesystem::path& mesh_file);

// The nodes of a line, or the one nearest to a point, which must lie within half an element of it. Throws InputError.
std::vector<std::int64_t> nodes_at(const Mesh& mesh, const Place& place);

MaterialPoints make_material_points(const Model& model);

// m, (equations): the nodal thickness, weighted by mass where nodes share an equation. A residual counts over it.
std::vector<double> equation_thickness(const Model& model, const Freedoms::Equations& equations);

// Element equation numbers (M, 12): u_x, u_y, p node by node.
std::vector<int> element_equations(const Mesh& mesh, const Freedoms::Equations& equations);

}  // namespace tailrun::fem

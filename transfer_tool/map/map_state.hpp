// Step 2 of the hand-over: the mesh's state at the points.
#pragma once

#include <vector>

#include "common/snapshot.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace tailrun::transfer {

// element: every point takes its element's value (the elements have one stress point, so this is the value that FEM's
// own balance of forces used). nodal: volume-weighted average of the elements of one region around each node,
// interpolated by the shape functions; never outside the range of those elements, so nothing overshoots and nothing
// leaks from one region into another. linear: the element's value plus a gradient fitted by least squares to the
// neighbours of the same region, scaled down until every point stays inside the neighbours' range (Barth and
// Jespersen 1989). An element on the edge of its region, a surface or a bed, has neighbours on one side only; there the
// range is mirrored about the element's own value, so that stress goes on falling towards a free surface. Exact for a
// linear field.
enum class Recovery { element, nodal, linear };

struct MapOptions {
  Recovery stress = Recovery::element;
  Recovery initial_stress = Recovery::linear;   // sigma'_v0
  Recovery pressure_ratio = Recovery::element;  // r_u
  bool maximum_pressure_ratio = false;          // largest r_u so far instead of the one at the snapshot's time
  bool depth_of_point = true;                   // below the initial ground surface; otherwise the element's
  bool remove_base_motion = true;
  bool equilibrate = false;  // stresses in balance on the particle stage's grid: balance/equilibrate.hpp
};

// Structure of arrays over the points.
struct PointState {
  std::vector<double> velocity;                           // m/s, (n, 2)
  std::vector<double> displacement;                       // m, (n, 2)
  std::vector<double> effective_stress;                   // Pa, (n, 4), tension positive
  std::vector<double> pore_pressure;                      // Pa
  std::vector<double> initial_vertical_effective_stress;  // Pa
  std::vector<double> excess_pore_pressure_ratio;         // 1
  std::vector<double> depth;                              // m
  std::vector<double> shear_strain;                       // 1
};

// (points, columns) values of an element field of shape (elements, columns).
std::vector<double> recovered(const Snapshot& snapshot, const SamplePoints& points, const std::vector<double>& field,
                              std::size_t columns, Recovery recovery);

// (points) values of a nodal field: sum of node weights times nodal values of component `k` of `columns`.
std::vector<double> interpolated(const Snapshot& snapshot, const SamplePoints& points, const std::vector<double>& field,
                                 std::size_t columns, std::size_t k);

// Pore pressure is the nodes' field, but 0 in elements whose total stress feels no suction: the points' total stress is
// then the one that held the elements in balance.
PointState map_state(const Snapshot& snapshot, const SamplePoints& points, const MapOptions& options);

// Puts the geostatic stress and pore pressure of another snapshot of the same mesh in place of this one's own record
// of them, and renews r_u from the pore pressures. Throws InputError when the meshes differ.
void take_initial_state(Snapshot& snapshot, const Snapshot& geostatic);

}  // namespace tailrun::transfer

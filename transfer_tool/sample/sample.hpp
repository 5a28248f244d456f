// Step 1 of the hand-over: material points in every kept element.
//
// Two layouts. `gauss`: n x n Gauss-Legendre points, as the paper does; their volumes differ (for n = 5 by a factor of
// 5.8). `uniform`: the element is cut into n x m equal cells of its parent square, one point each, which suits a
// particle method better and has no upper bound of 5.
//
// Both conserve. Mass is density x weight x *undeformed* Jacobian, the mass that FEM itself moves around, whose sum
// over the points is exactly the element's mass; position and volume use the *deformed* geometry (x + u, deformed
// Jacobian), so that stress times volume is the stress resultant of the mesh as it stands at the transfer. A point of
// the uniform layout carries, instead of shape functions at one place, their average over its cell weighted by mass:
// N_a = int N_a J0 / int J0. With it mass, centre of mass and linear momentum are the mesh's own to round-off for any
// point count, one point per element included, and a field that is linear in x is carried exactly. Gauss points have
// the same properties from n = 2 (the integrands have degree 2 in xi and eta); n = 1 is taken as uniform for that
// reason.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "transfer_tool/sample/quadrilateral.hpp"

namespace tailrun::transfer {

enum class Layout { gauss, uniform };
enum class InvertedElements { error, initial_volume };

struct SamplingOptions {
  Layout layout = Layout::gauss;
  InvertedElements inverted = InvertedElements::error;
  std::vector<int> points;        // by region: points along each side of an element; 0 = from cell_size
  double cell_size = 1.0;         // m, cells of the particle stage's grid
  double points_per_cell = 4.0;   // in the plane
  std::vector<bool> kept_region;  // by region
  std::array<double, 2> clip_x = {-1e300, 1e300};  // m, undeformed: elements whose centre lies outside are left out
  std::array<double, 2> clip_y = {-1e300, 1e300};
};

// Structure of arrays over the points; (n, 2) and (n, 4) are row-major.
struct SamplePoints {
  std::vector<std::int64_t> element;
  std::vector<double> node_weights;      // (n, 4): what multiplies the element's nodal values
  std::vector<double> initial_position;  // m, (n, 2)
  std::vector<double> position;          // m, (n, 2), deformed
  std::vector<double> mass;              // kg per metre of thickness
  std::vector<double> volume;            // m3 per metre of thickness
  long largest_count = 0;                // points along one side of an element, at most
  long capped_elements = 0;              // elements that wanted more than 5 Gauss points along a side
  std::size_t count() const { return mass.size(); }
};

// Which elements become particles.
std::vector<bool> kept_elements(const Snapshot& snapshot, const SamplingOptions& options);

// Points along xi and eta of an element: as many as its region has, or else mid-line length x sqrt(points per
// cell)/cell size, rounded, at least 1; Gauss: at most 5, and along both the larger. Beyond any integer for small
// cells: check_request (request_checks.hpp) comes before sample().
std::array<double, 2> points_in_element(const Corners& deformed, const SamplingOptions& options, std::size_t region);

// Throws InputError for an element that is folded before the deformation, or (unless `inverted` is initial_volume)
// at the snapshot's time.
SamplePoints sample(const Snapshot& snapshot, const std::vector<bool>& kept, const SamplingOptions& options);

}  // namespace tailrun::transfer

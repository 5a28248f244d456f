// The phreatic line as users of OpenSees and FLAC handle it: p = 0 is held at every node on and above it (option A of
// the u-p formulation's water table treatments).
#pragma once

#include <vector>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

// Elevation (m) of the phreatic line at x; the end values outside its range. `line` (k, 2).
double phreatic_elevation(const std::vector<double>& line, double x);

// (N): 1 where the node lies on or above the line (m, (k, 2)); all 1 when the line is empty (a dry model).
std::vector<char> on_or_above_phreatic_line(const Mesh& mesh, const std::vector<double>& line);

// Moves inner nodes nearer than `distance` (m, measured vertically) to the line vertically onto it, unless that would
// make an element's scaled Jacobian fall under 0.3 and under what it was. Returns how many were moved.
int snap_to_phreatic_line(Mesh& mesh, const std::vector<double>& line, double distance);

}  // namespace tailrun::fem

// A foundation that does not become particles becomes the bed of the particle stage: its interface with the kept
// elements and its own free surface, chained to a polyline in the deformed geometry.
#pragma once

#include <vector>

#include "common/particles.hpp"
#include "common/snapshot.hpp"

namespace tailrun::transfer {

struct TerrainOptions {
  std::string name = "bed";
  std::vector<bool> region;       // by region: part of the bed's body; must not be kept as particles
  double downstream_to = 0.0;     // m: x to which the last point is extended when `extend` is set
  bool extend = false;            // extend downstream of the mesh
  double downstream_slope = 0.0;  // degrees, falling downstream
  bool walls = false;             // also lines where the mesh is cut off, see wall_lines
  double wall_height = 10.0;      // m by which these go on above the ground
  bool any() const;
};

// Sides of the bed's elements that are shared with a kept element, or that face up (undeformed, within 84 degrees of
// level) and have no other bed element behind them, chained so that the kept material lies on the left of the walk.
// Several separate chains are named bed, bed_2 ..., from upstream to downstream. Throws InputError when there is none
// or when the chain branches.
std::vector<TerrainLine> terrain_lines(const Snapshot& snapshot, const std::vector<bool>& kept,
                                       const TerrainOptions& options);

// Where a kept element borders on one that is left out and is not bed (free-field columns, the far side of the clip):
// lines upstream_wall, downstream_wall, kept material on their left, for a smooth wall of the particle stage.
std::vector<TerrainLine> wall_lines(const Snapshot& snapshot, const std::vector<bool>& kept,
                                    const TerrainOptions& options);

}  // namespace tailrun::transfer

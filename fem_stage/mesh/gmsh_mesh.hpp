// Meshes by gmsh: a .msh file is read, a .geo file is meshed, through gmsh's own library.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

struct GeometryOptions {
  std::map<std::string, double> parameters;  // ONELAB numbers "Parameters/<name>"
  double time_limit = 600.0;                 // s
  bool trusted = false;                      // the geometry may start programs and write files (geo_commands.hpp)
};

// Meshes a .geo file in 2-D and writes the mesh to `output` (gmsh 4.1 ASCII), as it is when read back and checked
// (check_mesh). The user's own gmsh settings play no part. gmsh runs in a process of its own (isolated.hpp). Throws
// InputError: gmsh's own messages, commands that start programs or write files, a geometry that ends gmsh or takes too
// long.
Mesh mesh_geometry(const std::filesystem::path& geometry, const GeometryOptions& options,
                   const std::filesystem::path& output);

// Reads a .msh file of quadrilaterals with physical surfaces and curves, and checks it (msh_audit.hpp, check_mesh).
// Edges that a curve has twice count once. Throws InputError: missing or damaged file, triangles, second order,
// partitions, a sheet that is not in the x-y plane, elements in no or in two physical surfaces. Warns of line elements
// that touch no quadrilateral.
Mesh read_gmsh(const std::filesystem::path& path);

// The same, with another name for messages: `path` may be temporary.
Mesh read_gmsh(const std::filesystem::path& path, const std::string& source);

}  // namespace tailrun::fem

// Meshes by gmsh: a .msh file is read, a .geo file is meshed, through gmsh's own library.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

// Opens a .geo file with its ONELAB numbers set ("Parameters/<name>"), meshes it in 2-D, checks it (check_mesh), and
// writes it to `output` (gmsh 4.1 ASCII). Throws InputError with gmsh's own messages.
Mesh mesh_geometry(const std::filesystem::path& geometry, const std::map<std::string, double>& parameters,
                   const std::filesystem::path& output);

// Reads a .msh file of quadrilaterals with physical surfaces and curves, and checks it (check_mesh). Throws InputError:
// missing file, triangles, elements in no or in two physical surfaces.
Mesh read_gmsh(const std::filesystem::path& path);

}  // namespace tailrun::fem

// Whether the parts of a mesh hang together: two blocks side by side that were meshed with nodes of their own look like
// one body in every picture, and are cut.
#pragma once

#include "fem_stage/mesh/mesh.hpp"
#include "fem_stage/model/boundary_options.hpp"

namespace tailrun::fem {

// Throws InputError for nodes in one place (nearer than a hundredth of the sides around them) that no element joins. A
// free-field column may stand flush with the side that it belongs to. `source` names the mesh file.
void check_joints(const Mesh& mesh, const BoundaryOptions& boundaries, const std::string& source);

}  // namespace tailrun::fem

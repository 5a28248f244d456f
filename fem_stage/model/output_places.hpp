// Whether what the case wants to see is there to be seen: histories at places on the mesh.
#pragma once

#include "fem_stage/mesh/mesh.hpp"
#include "fem_stage/model/fem_case.hpp"

namespace tailrun::fem {

// Throws InputError for a point or element of /output that lies more than one element away from the nearest one: its
// history would be that of another place.
void check_output_places(const Mesh& mesh, const FemCase& options);

}  // namespace tailrun::fem

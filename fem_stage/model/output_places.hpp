// Whether what the case wants to see is there to be seen: histories at places on the mesh.
#pragma once

#include <vector>

#include "fem_stage/mesh/mesh.hpp"
#include "fem_stage/model/fem_case.hpp"

namespace tailrun::fem {

// Throws InputError for a point or element of /output that lies more than one element away from the nearest one: its
// history would be that of another place. And for a region or window of /output/liquefaction that no element lies in.
void check_output_places(const Mesh& mesh, const FemCase& options);

// Elements of /output/liquefaction: of its region, with their centre in the window. Empty without one; throws as above.
std::vector<std::size_t> liquefaction_elements(const Mesh& mesh, const OutputOptions& output);

}  // namespace tailrun::fem

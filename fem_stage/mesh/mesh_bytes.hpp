// A mesh, and what there is to say about it, on its way from one process to another of the same program.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

std::string bytes_of(const Mesh& mesh, const std::vector<std::string>& remarks);

// Throws ComputationError when the bytes are not what bytes_of made.
std::pair<Mesh, std::vector<std::string>> mesh_of_bytes(const std::string& bytes);

}  // namespace tailrun::fem

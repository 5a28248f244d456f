// .msh files: what is read of them before gmsh is let near them.
#include "fem_stage/mesh/msh_audit.hpp"
#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(mesh_file, "mesh.msh", path) {
  tailrun::fem::audit_msh(path, path.string());
}

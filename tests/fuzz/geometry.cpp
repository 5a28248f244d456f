// .geo files: the search for commands that start programs or write files.
#include "fem_stage/mesh/geo_commands.hpp"
#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(geometry, "mesh.geo", path) {
  tailrun::fem::refuse_commands(path);
}

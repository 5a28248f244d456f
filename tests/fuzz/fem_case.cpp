// fem.json: what a case says of the FEM stage, with its materials, loads and requests.
#include "fem_stage/model/fem_case.hpp"

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(fem_case, "fem.json", path) {
  tailrun::fem::read_fem_case(path, "");
}

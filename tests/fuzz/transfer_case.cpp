// transfer.json: sampling, terrain, materials and strengths of a hand-over.
#include "transfer_tool/options/transfer_case.hpp"

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(transfer_case, "transfer.json", path) {
  const tailrun::CaseFile file(path);
  tailrun::transfer::read_transfer_case(file, {"foundation", "embankment", "tailings"});
  file.finish();
}

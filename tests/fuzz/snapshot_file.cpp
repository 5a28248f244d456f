// Snapshots (HDF5). Those of the corpus have no checksums, so that a changed byte gets through to our reader.
#include "common/snapshot.hpp"

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(snapshot_file, "snapshot.h5", path) {
  const auto snapshot = tailrun::read_snapshot(path);
  const auto nodes = static_cast<std::int64_t>(snapshot.nodes());
  for (const auto node : snapshot.quads) tailrun::fuzz::require(node >= 0 && node < nodes, "a node is out of range");
}

// transfer.json: everything that a hand-over is told.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "transfer_tool/assign/rules.hpp"
#include "transfer_tool/map/map_state.hpp"
#include "transfer_tool/sample/sample.hpp"
#include "transfer_tool/sample/terrain.hpp"

namespace tailrun::transfer {

struct TransferCase {
  std::optional<double> transfer_time;  // s; which snapshot the case wants
  SamplingOptions sampling;
  TerrainOptions terrain;
  MapOptions state;
  std::vector<Rule> rules;
};

// Reads and checks the whole file against the snapshot's region names; `size` picks an entry of /sizes (empty: none).
// Throws InputError.
TransferCase read_transfer_case(const CaseFile& file, const std::vector<std::string>& region_names,
                                const std::string& size = {});

}  // namespace tailrun::transfer

// A hand-over that asks for more points than the machine holds is refused before it makes the first, with the numbers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/case_file.hpp"
#include "transfer_tool/sample/sample.hpp"

namespace tailrun::transfer {

// Points that sample() will make; a request can be beyond any integer.
double points_asked_for(const Snapshot& snapshot, const std::vector<bool>& kept, const SamplingOptions& options);

// Throws InputError at the key that asks for them (of `size`, where that has its own cell size): more points than this
// machine's memory holds, or, unless `output` is empty, than the disk under it has room for.
void check_request(const CaseFile& file, const std::string& size, const Snapshot& snapshot,
                   const std::vector<bool>& kept, const SamplingOptions& options, const std::filesystem::path& output);

}  // namespace tailrun::transfer

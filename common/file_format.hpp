// The head of every file of the chain: attributes `format` and `format_version` of the group /tailrun, and checks that
// both file formats share.
#pragma once

#include <string>
#include <vector>

#include "common/hdf5_file.hpp"

namespace tailrun {

void write_format(Hdf5Writer& file, const std::string& format, int format_version);

// Throws InputError when the file is of another kind, or of a version that this program does not know.
void check_format(const Hdf5Reader& file, const std::string& format, int format_version);

// Throws InputError naming the first entry that is not above zero.
void check_positive(const Hdf5Reader& file, const std::string& name, const std::vector<double>& values);

// Throws InputError when an index lies outside [low, high).
template <typename Integer>
void check_indices(const Hdf5Reader& file, const std::string& name, const std::vector<Integer>& values,
                   std::int64_t low, std::int64_t high) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < low || values[i] >= high)
      file.fail(name, "entry " + std::to_string(i) + " is " + std::to_string(values[i]) + ", but allowed is [" +
                          std::to_string(low) + ", " + std::to_string(high) + ")");
}

}  // namespace tailrun

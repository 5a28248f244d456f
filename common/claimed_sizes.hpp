// A damaged HDF5 file can claim any size for its datasets. Reading one must end in a message, not in a machine without
// memory.
#pragma once

#include <hdf5.h>

#include <filesystem>

namespace tailrun {

// Throws InputError when a dataset or attribute of the open `file` claims more bytes than 1100 times the size of the
// file at `path`, which is beyond what deflate can pack (1032:1), or when the file cannot be walked through.
void check_claimed_sizes(hid_t file, const std::filesystem::path& path);

}  // namespace tailrun

// What an HDF5 file may look like before anything is read from it. A damaged or foreign file can claim any size, lead
// in circles, or point at other files of the machine; reading one must end in a message.
#pragma once

#include <hdf5.h>

#include <filesystem>

namespace tailrun {

// Walks through the open `file`, which lies at `path`. Throws InputError with the object's name when
//   - a dataset or attribute claims more bytes than 1100 times the size of the file, which is beyond what deflate can
//     pack (1032:1),
//   - a group has more than one place (with which links can lead in circles),
//   - a link is soft or external, or a dataset's values lie in other files (external storage, virtual datasets): what
//     is read must be in the file that provenance sums,
//   - an object cannot be opened.
void check_structure(hid_t file, const std::filesystem::path& path);

// Files without checksums in their headers (those with a superblock before version 2, h5py's default) can lead the
// library itself astray where they are damaged. This walks through such a file and reads its values in a process of
// its own first. Throws InputError when that process does not live through it. Files of this toolchain have checksums
// and are not read twice.
void check_survives_reading(const std::filesystem::path& path);

// The version of the file's superblock; -1 when `path` does not begin with one.
int superblock_version(const std::filesystem::path& path);

}  // namespace tailrun

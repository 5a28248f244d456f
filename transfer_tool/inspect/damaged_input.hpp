// A damaged HDF5 file can claim any size for its datasets. Reading one must end in a message, not in a machine without
// memory.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <stdexcept>

#include "common/error.hpp"

namespace tailrun::transfer {

// Throws InputError when a dataset or attribute claims more bytes than 1100 times the file's size, which is beyond what
// deflate can pack (1032:1), or when the file cannot be walked through. A file that cannot be opened at all is left to
// whoever reads it.
void check_claimed_sizes(const std::filesystem::path& path);

// What `read(path)` returns. Throws InputError also where it runs out of memory or beyond a container's largest size.
template <typename Read>
auto read_undamaged(const std::filesystem::path& path, Read&& read) {
  check_claimed_sizes(path);
  try {
    return read(path);
  } catch (const std::length_error&) {
  } catch (const std::bad_alloc&) {
  }
  throw InputError(
      fmt::format("{}: a dataset claims an impossible size; the file is damaged. Make it again", path.string()));
}

}  // namespace tailrun::transfer

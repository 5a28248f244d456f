// How much memory there is, for requests to be held against it before they are begun.
#pragma once

#include <unistd.h>

namespace tailrun {

// Bytes of this machine's physical memory.
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace tailrun

// One writer per results' folder. Two runs that write to one folder would each take the other's frames, rows and
// checkpoints for their own, so the second is told who is there and ends before it computes.
//
// The lock is the kernel's (flock) on `.tailrun_lock` in the folder: it goes with the process, however that ends, so
// none is left behind by one that was killed. The file says who holds it and is removed when the program ends. File
// systems that know no such locks (some network ones) are written to without.
#pragma once

#include <filesystem>

namespace tailrun {

// check_output_folder(), and keeps the folder for this process until it ends. Again for a folder it holds already: does
// nothing. Throws InputError when another process holds it.
void hold_output_folder(const std::filesystem::path& folder);

// For tests, which take several programs' parts in one process.
void release_output_folders();

}  // namespace tailrun

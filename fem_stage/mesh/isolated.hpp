// Work that must not take the program with it: gmsh ends the process at "Exit;", crashes on some damaged files and
// loops for ever on others. It runs in a child of its own, with a limit on time and memory.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace tailrun::fem {

struct IsolationLimits {
  double seconds = 600.0;           // wall time
  std::size_t memory = 0;           // bytes beyond what the program has now; 0: no limit
  bool may_start_programs = false;  // else execve is refused to the child, where the kernel can (seccomp)
  std::string time_limit_name;      // what sets `seconds`, for the message
};

// What `work` returns, from a child process. Throws what it threw when that was an InputError or a ComputationError;
// and InputError, beginning with `what`, when the child ended by itself, crashed, or passed a limit. To be called while
// no other thread runs.
std::string run_isolated(const std::string& what, const IsolationLimits& limits,
                         const std::function<std::string()>& work);

}  // namespace tailrun::fem

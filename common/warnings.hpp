// What a run should have been told about although it can go on. A warning is said in the log at once and kept for the
// result's summary, so that it is still there when the log is gone.
#pragma once

#include <string>
#include <vector>

namespace tailrun {

// Logs `text` (shown with --quiet, too) and keeps it. The same text counts once, however often the input is read.
void add_warning(const std::string& text);

// All warnings of this process so far, in the order in which they came.
const std::vector<std::string>& warnings();

// For tests, which share one process.
void forget_warnings();

}  // namespace tailrun

// Ctrl-C and the end of a batch job: the run stops between two steps with a checkpoint instead of being cut off.
#pragma once

#include <string>

namespace tailrun {

// From now on the first SIGINT or SIGTERM is only noted down; a second one ends the program at once.
void note_signals();

// "SIGINT" or "SIGTERM" once it has come, else empty.
std::string noted_signal();

}  // namespace tailrun

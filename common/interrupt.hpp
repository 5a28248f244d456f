// Ctrl-C and the end of a batch job: the run stops between two steps, with a checkpoint where it has any, instead of
// being cut off.
#pragma once

#include <string>

namespace tailrun {

// From now on the first SIGINT or SIGTERM is only noted down; a second one ends the program at once.
void note_signals();

// "SIGINT" or "SIGTERM" once it has come, else empty.
std::string noted_signal();

// For work that is done in steps and keeps nothing of them: throws InterruptedError, naming the step that comes `next`,
// once a signal has come.
void stop_if_told(const std::string& next);

}  // namespace tailrun

#include "common/interrupt.hpp"

#include <fmt/core.h>

#include <csignal>

#include "common/error.hpp"

namespace tailrun {

namespace {

volatile std::sig_atomic_t noted = 0;

}  // namespace

extern "C" {
static void note(int signal) {
  noted = signal;
}
}

void note_signals() {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::string noted_signal() {
  return noted == SIGINT ? "SIGINT" : noted == SIGTERM ? "SIGTERM" : "";
}

void stop_if_told(const std::string& next) {
  if (const std::string signal = noted_signal(); !signal.empty())
    throw InterruptedError(fmt::format("stopped by {} before it went on to {}; nothing was written", signal, next));
}

}  // namespace tailrun

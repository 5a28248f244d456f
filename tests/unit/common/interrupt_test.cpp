// A program that is told to end stops before its next step, with an exit status of its own choice.
#include "common/interrupt.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/error.hpp"

using namespace tailrun;

namespace {

// Exit status of a process that gets `signal` (0: none) and then comes to its next step; a signal is never taken back,
// so it is another process.
int status_after(int signal) {
  const pid_t child = fork();
  if (child == 0) {
    note_signals();
    if (signal != 0) raise(signal);
    try {
      stop_if_told("the writing");
    } catch (const InterruptedError& error) {
      _exit(std::string(error.what()).find("before it went on to the writing") == std::string::npos
                ? 9
                : exit_computation_failed);
    }
    _exit(exit_done);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("SIGTERM and SIGINT end a program before its next step, with status 2") {
  CHECK(status_after(0) == exit_done);
  CHECK(status_after(SIGTERM) == exit_computation_failed);
  CHECK(status_after(SIGINT) == exit_computation_failed);
}

#include "common/output_lock.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "common/error.hpp"

namespace fs = std::filesystem;

TEST_CASE("a folder has one writer: another process is refused and told who it is, until it is gone, however it goes") {
  const fs::path folder = fs::temp_directory_path() / ("tailrun_lock_" + std::to_string(getpid()));
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t holder = fork();
  if (holder == 0) {
    tailrun::hold_output_folder(folder);
    if (write(ready[1], "x", 1) != 1) _exit(1);
    pause();
    _exit(0);
  }
  char said = 0;
  REQUIRE(read(ready[0], &said, 1) == 1);
  CHECK_THROWS_WITH_AS(tailrun::hold_output_folder(folder),
                       doctest::Contains(("process " + std::to_string(holder) + " on ").c_str()), tailrun::InputError);
  kill(holder, SIGKILL);
  waitpid(holder, nullptr, 0);
  CHECK(fs::exists(folder / ".tailrun_lock"));  // left behind, and held by nobody
  tailrun::hold_output_folder(folder);
  tailrun::hold_output_folder(folder / "." / "");  // again: its own
  std::ifstream text(folder / ".tailrun_lock");
  std::string word, number;
  text >> word >> number;
  CHECK(number == std::to_string(getpid()));
  tailrun::release_output_folders();
  CHECK_FALSE(fs::exists(folder / ".tailrun_lock"));
  fs::remove_all(folder);
}

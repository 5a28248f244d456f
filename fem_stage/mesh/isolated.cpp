#include "fem_stage/mesh/isolated.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <omp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

enum Outcome : char { result = 'R', input_error = 'I', computation_error = 'C' };

void write_all(int file, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = write(file, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(3);
    data += n;
    size -= static_cast<std::size_t>(n);
  }
}

// execve answers "not permitted" from now on. A kernel without seccomp leaves it: the geometry has been read for
// commands before (geo_commands.hpp), this is the second lock.
void refuse_programs() {
  sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_execve, 1, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_execveat, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  sock_fprog program{sizeof filter / sizeof *filter, filter};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

void limit_memory(std::size_t allowed) {
#ifndef __SANITIZE_ADDRESS__  // whose shadow takes terabytes of address space
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  if (allowed == 0 || !(statm >> pages)) return;
  const rlim_t bytes = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + allowed;
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
#else
  (void)allowed;
#endif
}

[[noreturn]] void child(int pipe, const IsolationLimits& limits, const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
#ifndef __SANITIZE_ADDRESS__
  // What a crash in the C library prints is not for the user; and nothing that is buffered is written twice.
  const int null = open("/dev/null", O_WRONLY);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
#endif
  omp_set_num_threads(1);
  limit_memory(limits.memory);
  if (!limits.may_start_programs) {
    setenv("HOME", "/nonexistent", 1);  // where gmsh's widgets leave a folder
    refuse_programs();
  }
  char outcome = Outcome::result;
  std::string text;
  try {
    text = work();
  } catch (const InputError& error) {
    outcome = Outcome::input_error;
    text = error.what();
  } catch (const std::bad_alloc&) {
    outcome = Outcome::input_error;
    text = "out of memory";
  } catch (const std::exception& error) {
    outcome = Outcome::computation_error;
    text = error.what();
  }
  write_all(pipe, &outcome, 1);
  write_all(pipe, text.data(), text.size());
  _exit(0);
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("gmsh crashed on it ({}): the file is damaged, or asks for what this version of gmsh cannot do",
                       strsignal(WTERMSIG(status)));
  return "it ended gmsh before the mesh was done ('Exit' in the geometry?)";
}

}  // namespace

std::string run_isolated(const std::string& what, const IsolationLimits& limits,
                         const std::function<std::string()>& work) {
  std::fflush(nullptr);
  int ends[2];
  if (pipe(ends) != 0) throw ComputationError(fmt::format("{}: no pipe: {}", what, std::strerror(errno)));
  const pid_t process = fork();
  if (process < 0) throw ComputationError(fmt::format("{}: no child process: {}", what, std::strerror(errno)));
  if (process == 0) {
    close(ends[0]);
    child(ends[1], limits, work);
  }
  close(ends[1]);
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                             std::chrono::duration<double>(std::min(limits.seconds, 1e8)));
  std::string answer;
  bool late = false;
  for (char buffer[1 << 16];;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd wait{ends[0], POLLIN, 0};
    const int ready = left > 0 ? poll(&wait, 1, static_cast<int>(std::min<long>(left, 1000))) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0 && left <= 0) {
      late = true;
      kill(process, SIGKILL);
      break;
    }
    if (ready <= 0) continue;
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    answer.append(buffer, static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (late)
    throw InputError(
        fmt::format("{}: gmsh was not done after {:g} s{} and was stopped: does a macro or a loop in it "
                    "never end?",
                    what, limits.seconds, limits.time_limit_name.empty() ? "" : " (" + limits.time_limit_name + ")"));
  const bool whole = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !answer.empty();
  if (!whole) throw InputError(fmt::format("{}: {}", what, how_it_ended(status)));
  const char outcome = answer.front();
  answer.erase(0, 1);
  if (outcome == Outcome::result) return answer;
  if (outcome == Outcome::computation_error) throw ComputationError(fmt::format("{}: {}", what, answer));
  throw InputError(answer == "out of memory"
                       ? fmt::format("{}: gmsh needs more memory for it than is allowed here ({:.1f} GB)", what,
                                     1e-9 * static_cast<double>(limits.memory))
                       : answer);
}

}  // namespace tailrun::fem

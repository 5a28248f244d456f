#include "common/output_lock.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <map>
#include <string>

#include "common/error.hpp"
#include "common/output_place.hpp"

namespace tailrun {
namespace {

namespace fs = std::filesystem;

// Open as long as the process lives, by the folder's own name.
class Locks {
 public:
  ~Locks() { release(); }
  bool has(const fs::path& folder) const { return held_.contains(folder); }
  void add(const fs::path& folder, int descriptor) { held_[folder] = descriptor; }
  void release();

 private:
  std::map<fs::path, int> held_;
};

fs::path lock_file(const fs::path& folder) {
  return folder / ".tailrun_lock";
}

// Only one's own file is removed, while its lock is still held: whoever has opened it sees that its name is gone.
void Locks::release() {
  for (const auto& [folder, descriptor] : held_) {
    unlink(lock_file(folder).c_str());
    close(descriptor);
  }
  held_.clear();
}

Locks& locks() {
  static Locks all;
  return all;
}

// Its holder writes it a moment after it has the lock.
std::string text_of(int descriptor) {
  std::array<char, 512> text{};
  ssize_t length = 0;
  for (int tries = 0; tries < 100 && length <= 0; ++tries) {
    if (tries > 0) usleep(2000);
    length = pread(descriptor, text.data(), text.size(), 0);
  }
  std::string said(text.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  while (!said.empty() && said.back() == '\n') said.pop_back();
  return said.empty() ? "another process" : said;
}

void say_who(int descriptor) {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const std::string text =
      fmt::format("process {} on {}, since {:%Y-%m-%d %H:%M:%S} UTC\n", getpid(), host.data(), fmt::gmtime(now));
  // Without space left, or read-only, the lock holds all the same.
  if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, text.data(), text.size(), 0) < 0) return;
}

// Whether the file that was opened still has its name: its holder may have removed it in between.
bool has_its_name(int descriptor, const fs::path& path) {
  struct stat open_file {
  }, named{};
  return fstat(descriptor, &open_file) == 0 && stat(path.c_str(), &named) == 0 && open_file.st_ino == named.st_ino &&
         open_file.st_dev == named.st_dev;
}

}  // namespace

void hold_output_folder(const fs::path& folder) {
  check_output_folder(folder);
  const fs::path name = fs::canonical(folder);
  if (locks().has(name)) return;
  const fs::path path = lock_file(name);
  for (;;) {
    int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);  // another user's
    if (descriptor < 0) return;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      const std::string holder = taken ? text_of(descriptor) : "";
      close(descriptor);
      if (!taken) return;
      throw InputError(
          fmt::format("{}: another run writes to this folder ({}); wait for its end, or give another folder with -o",
                      folder.string(), holder));
    }
    if (has_its_name(descriptor, path)) {
      say_who(descriptor);
      locks().add(name, descriptor);
      return;
    }
    close(descriptor);
  }
}

void release_output_folders() {
  locks().release();
}

}  // namespace tailrun

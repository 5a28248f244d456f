#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "common/error.hpp"
#include "common/hdf5_handle.hpp"
#include "common/warnings.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace tailrun::fuzz {
namespace {

namespace fs = std::filesystem;

// Removed at the end; in memory where there is such a place, since it is written some hundred times a second.
struct Folder {
  fs::path path;
  Folder() {
    std::error_code ignored;
    const fs::path memory = "/dev/shm";
    path = (fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path()) /
           ("tailrun_fuzz_" + std::to_string(getpid()));
    fs::create_directories(path);
    for (const char* name : {"mesh.geo", "mesh.msh", "motion.csv"}) std::ofstream(path / name);  // that cases name
    spdlog::set_level(spdlog::level::off);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

int read_input(const char* file_name, Read read, const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const fs::path path = folder.path / file_name;
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    read(path);
  } catch (const InputError& error) {
    require(std::string(error.what()).find(folder.path.string()) != std::string::npos, "the message names no file");
  }
  forget_warnings();
  return 0;
}

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

}  // namespace tailrun::fuzz

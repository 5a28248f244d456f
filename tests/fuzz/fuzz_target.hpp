// One fuzz target: FUZZ_TARGET(name, "file name") { ... } is given each input as a file of that name and reads it.
// Right is to read it or to refuse it with an InputError; everything else ends the process, which is how libFuzzer and
// the replay notice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tailrun::fuzz {

using Read = void (*)(const std::filesystem::path&);

// Puts the input into a file of its own folder and reads it.
int read_input(const char* file_name, Read read, const std::uint8_t* data, std::size_t size);

// Ends the process, saying `what`, unless `holds`: of what has been read.
void require(bool holds, const char* what);

struct Registration {  // for the replay, which has all targets in one program
  Registration(const char* name, int (*input)(const std::uint8_t*, std::size_t));
};

}  // namespace tailrun::fuzz

#define TAILRUN_FUZZ_BODY(name, file_name, path)                          \
  static void read_##name(const std::filesystem::path& path);             \
  static int input_##name(const std::uint8_t* data, std::size_t size) {   \
    return tailrun::fuzz::read_input(file_name, read_##name, data, size); \
  }
#ifdef TAILRUN_FUZZ_REPLAY
#define FUZZ_TARGET(name, file_name, path)                                           \
  TAILRUN_FUZZ_BODY(name, file_name, path)                                           \
  static const tailrun::fuzz::Registration registration_##name(#name, input_##name); \
  static void read_##name(const std::filesystem::path& path)
#else
#define FUZZ_TARGET(name, file_name, path)                                            \
  TAILRUN_FUZZ_BODY(name, file_name, path)                                            \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    return input_##name(data, size);                                                  \
  }                                                                                   \
  static void read_##name(const std::filesystem::path& path)
#endif

// The committed corpus, given to each target: CORPUS/<target>/*. Exit status 1 when a target has no inputs.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "tests/fuzz/fuzz_target.hpp"

namespace {

using Input = int (*)(const std::uint8_t*, std::size_t);

std::map<std::string, Input>& targets() {
  static std::map<std::string, Input> known;
  return known;
}

}  // namespace

tailrun::fuzz::Registration::Registration(const char* name, Input input) {
  targets()[name] = input;
}

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: fuzz_replay CORPUS\n"), 1;
  for (const auto& [name, input] : targets()) {
    std::vector<std::filesystem::path> files;
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(argv[1]) / name, failed))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      std::fprintf(stderr, "%s\n", file.c_str());  // before it is read: the last one named is the one that failed
      std::ifstream stream(file, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
      input(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%s: %zu inputs\n", name.c_str(), files.size());
    if (files.empty()) return std::fprintf(stderr, "%s/%s has no inputs\n", argv[1], name.c_str()), 1;
  }
  return 0;
}

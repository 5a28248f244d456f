// Where a file came from: program, version, and the inputs' texts and SHA-256 sums, stored as attributes of the group
// /tailrun/provenance.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/hdf5_file.hpp"

namespace tailrun {

std::string version();  // of the toolchain

struct Provenance {
  std::string program;                                      // "fem_stage"
  std::vector<std::pair<std::string, std::string>> texts;   // (file name, full text) of the case files read
  std::vector<std::pair<std::string, std::string>> sha256;  // (file name, hexadecimal sum) of every input file
  std::vector<std::filesystem::path> inputs{};              // where those are; not written

  void add_text(const std::filesystem::path& path, const std::string& text);  // also sums it
  void add_file(const std::filesystem::path& path);  // sum only; throws InputError if unreadable
};

std::string sha256_of_text(const std::string& text);
std::string sha256_of_file(const std::filesystem::path& path);

void write_provenance(Hdf5Writer& file, const Provenance& provenance);

}  // namespace tailrun

// What the three programs do around their computations: how much they say, and the texts beside their results.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tailrun {

// --quiet: no progress, and messages only from warnings on.
void set_quiet();
bool quiet();

// Of the lines of CaseFile::echo those whose value is not the default.
std::vector<std::string> differing_options(const std::vector<std::string>& lines);

// Of a case file's options (CaseFile::echo) those that differ from their defaults, on standard error unless --quiet,
// and where all of them stand: `all`, which write_options makes.
void echo_options(const std::string& title, const std::vector<std::string>& lines, const std::filesystem::path& all);
void write_options(const std::filesystem::path& all, const std::string& title, const std::vector<std::string>& lines);

// Writes a text file under a temporary name and renames it. Throws InputError when the place is wrong
// (output_place.hpp), ComputationError when it cannot be written.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace tailrun

// What the three programs' mains have in common: options --quiet and --version, messages on standard error through
// spdlog, and exceptions turned into exit statuses.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tailrun {

// Adds --quiet, --verbose, --threads and --version, and sets up messages. To be called before anything else: it also
// sees to standard streams that are closed, and to how the HDF5 library ends.
void add_common_options(CLI::App& app);
bool quiet();

// Parses the command line and runs the chosen sub-command's callback. Returns the exit status: 0 done, 1 bad input
// (InputError or a wrong command line), 2 the computation failed (anything else).
int run_application(CLI::App& app, int argc, char** argv);

// Of a case file's options (CaseFile::echo) those that differ from their defaults, on standard error unless --quiet,
// and where all of them stand: `all`, which write_options makes.
void echo_options(const std::string& title, const std::vector<std::string>& lines, const std::filesystem::path& all);
void write_options(const std::filesystem::path& all, const std::string& title, const std::vector<std::string>& lines);

// Writes a text file under a temporary name and renames it. Throws InputError when the place is wrong
// (output_place.hpp), ComputationError when it cannot be written.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace tailrun

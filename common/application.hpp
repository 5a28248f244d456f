// What the three programs' mains have in common: options --quiet and --version, messages on standard error through
// spdlog, and exceptions turned into exit statuses.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace tailrun {

// Adds --quiet, --verbose, --threads and --version, and sets up messages. To be called before anything else: it also
// sees to standard streams that are closed, and to how the HDF5 library ends.
void add_common_options(CLI::App& app);
bool quiet();

// Parses the command line and runs the chosen sub-command's callback. Returns the exit status: 0 done, 1 bad input
// (InputError or a wrong command line), 2 the computation failed (anything else).
int run_application(CLI::App& app, int argc, char** argv);

// Messages on standard error; `echo_options` prints a case file's options, one a line, unless --quiet.
void echo_options(const std::string& title, const std::vector<std::string>& lines);

// Writes a text file under a temporary name and renames it. Throws InputError when the place is wrong
// (output_place.hpp), ComputationError when it cannot be written.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace tailrun

// The command line of a program with sub-commands, by CLI11: what the three mains need of it, compiled once. (CLI11 is
// headers only, and a dozen seconds of compiler time in each file that includes it.)
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tailrun {

// One sub-command. What an option is given goes into the variable that it was added with, which must outlive the
// program's CommandLine. `name` as CLI11 has it: "case" an argument by its place, "-o,--output" an option.
class SubCommand {
 public:
  enum class Need { optional, required };

  void add(const char* name, std::string& value, const char* what, Need need = Need::optional);
  void add(const char* name, std::filesystem::path& value, const char* what, Need need = Need::optional);
  // Numbers of [low, high]; a list is separated by commas.
  void add(const char* name, double& value, const char* what, double low, double high);
  void add(const char* name, std::vector<double>& values, const char* what, double low, double high);
  void add_flag(const char* name, bool& value, const char* what);
  // What the sub-command does, once the whole command line is read.
  void does(std::function<void()> work);

 private:
  friend class CommandLine;
  explicit SubCommand(CLI::App* app) : app_(app) {}
  CLI::App* app_;
};

// Has --quiet, --verbose, --threads, --set and --version beside its sub-commands, one of which has to be called. To be
// made before anything else: it sets up messages, sees to standard streams that are closed, and to how the HDF5 library
// ends.
class CommandLine {
 public:
  CommandLine(const char* description, const char* program);
  ~CommandLine();

  SubCommand add_command(const char* name, const char* what);
  // Does what the command line says. Returns the exit status: 0 done, 1 bad input (InputError or a wrong command line),
  // 2 the computation failed (anything else).
  int run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace tailrun

#include "common/command_line.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <new>

#include "common/application.hpp"
#include "common/case_settings.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "common/output_place.hpp"
#include "common/patient_threads.hpp"
#include "common/provenance.hpp"

namespace tailrun {
namespace {

// A program may be started with its standard streams closed. The next file opened would then get their numbers, and
// messages would go into results.
void occupy_standard_streams() {
  int descriptor = 0;
  do descriptor = open("/dev/null", O_RDWR);
  while (descriptor >= 0 && descriptor <= 2);
  if (descriptor > 2) close(descriptor);
}

}  // namespace

void SubCommand::add(const char* name, std::string& value, const char* what, Need need) {
  CLI::Option* option = app_->add_option(name, value, what)->required(need == Need::required);
  if (!value.empty()) option->capture_default_str();
}

void SubCommand::add(const char* name, std::filesystem::path& value, const char* what, Need need) {
  app_->add_option_function<std::string>(
          name, [&value](const std::string& text) { value = text; }, what)
      ->required(need == Need::required);
}

void SubCommand::add(const char* name, double& value, const char* what, double low, double high) {
  app_->add_option(name, value, what)->check(CLI::Range(low, high));
}

void SubCommand::add(const char* name, std::vector<double>& values, const char* what, double low, double high) {
  app_->add_option(name, values, what)->delimiter(',')->check(CLI::Range(low, high));
}

void SubCommand::add_flag(const char* name, bool& value, const char* what) {
  app_->add_flag(name, value, what);
}

void SubCommand::does(std::function<void()> work) {
  app_->callback(std::move(work));
}

CommandLine::CommandLine(const char* description, const char* program)
    : app_(std::make_unique<CLI::App>(description, program)) {
  occupy_standard_streams();
  // Files are closed where they are used. At exit the library would close once more one that could not be written for
  // want of space, and crash.
  H5dont_atexit();
  log_plain_lines();
  app_->set_version_flag("--version", app_->get_name() + " " + version());
  app_->add_flag_callback("--quiet,-q", set_quiet, "No progress and no messages other than warnings and errors");
  app_->add_flag_callback(
      "--verbose", [] { log_from(MessageLevel::debug); }, "Say more: steps that were cut, and why");
  app_->add_option_function<int>(
          "--threads", [](int count) { set_threads(count); },
          "OpenMP threads (default: OMP_NUM_THREADS, else as many of the cores as the scene keeps busy); the results "
          "do not depend on it")
      ->check(CLI::Range(1, 1024));
  // One value for each --set: what follows is an argument of the command again.
  app_->add_option_function<std::vector<std::string>>(
          "--set", [](const std::vector<std::string>& texts) { use_settings(texts); },
          "/json/pointer=value: this value in place of the case file's (may be repeated)")
      ->type_name("SETTING")
      ->type_size(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app_->fallthrough();
  app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

SubCommand CommandLine::add_command(const char* name, const char* what) {
  return SubCommand(app_->add_subcommand(name, what));
}

int CommandLine::run(int argc, char** argv) {
  const std::string program = app_->get_name();
  try {
    app_->parse(argc, argv);
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? exit_done : exit_bad_input;
  } catch (const InputError& error) {
    log_error("{}: {}", program, error.what());
    // Not every message knows where a value came from.
    if (std::string(error.what()).find("--set") == std::string::npos && !settings_in_use().empty())
      log_error("{}: the case file was read with{}", program, settings_as_options());
    return exit_bad_input;
  } catch (const InterruptedError& error) {
    log_error("{}: {}", program, error.what());
    return exit_computation_failed;
  } catch (const ComputationError& error) {
    log_error("{}: the computation failed: {}", program, error.what());
    return exit_computation_failed;
  } catch (const std::bad_alloc&) {
    log_error("{}: the computation failed: not enough memory", program);
    return exit_computation_failed;
  } catch (const std::filesystem::filesystem_error& error) {
    log_error("{}: {}", program, words_for(error));
    return exit_computation_failed;
  } catch (const std::exception& error) {
    log_error("{}: unexpected error: {}", program, error.what());
    return exit_computation_failed;
  }
}

}  // namespace tailrun

#include "common/application.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>

#include "common/case_settings.hpp"
#include "common/error.hpp"
#include "common/output_place.hpp"
#include "common/patient_threads.hpp"
#include "common/provenance.hpp"

namespace tailrun {
namespace {

bool is_quiet = false;

// A program may be started with its standard streams closed. The next file opened would then get their numbers, and
// messages would go into results.
void occupy_standard_streams() {
  int descriptor = 0;
  do descriptor = open("/dev/null", O_RDWR);
  while (descriptor >= 0 && descriptor <= 2);
  if (descriptor > 2) close(descriptor);
}

}  // namespace

bool quiet() {
  return is_quiet;
}

void add_common_options(CLI::App& app) {
  occupy_standard_streams();
  // Files are closed where they are used. At exit the library would close once more one that could not be written for
  // want of space, and crash.
  H5dont_atexit();
  auto logger = spdlog::stderr_logger_st("tailrun");
  logger->set_pattern("%v");
  spdlog::set_default_logger(logger);
  app.set_version_flag("--version", app.get_name() + " " + version());
  app.add_flag_callback(
      "--quiet,-q",
      [] {
        is_quiet = true;
        spdlog::set_level(spdlog::level::warn);
      },
      "No progress and no messages other than warnings and errors");
  app.add_flag_callback(
      "--verbose", [] { spdlog::set_level(spdlog::level::debug); }, "Say more: steps that were cut, and why");
  app.add_option_function<int>(
         "--threads", [](int count) { set_threads(count); },
         "OpenMP threads (default: OMP_NUM_THREADS, else as many of the cores as the scene keeps busy); the results do "
         "not "
         "depend on it")
      ->check(CLI::Range(1, 1024));
  // One value for each --set: what follows is an argument of the command again.
  app.add_option_function<std::vector<std::string>>(
         "--set", [](const std::vector<std::string>& texts) { use_settings(texts); },
         "/json/pointer=value: this value in place of the case file's (may be repeated)")
      ->type_name("SETTING")
      ->type_size(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.fallthrough();
}

int run_application(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_bad_input;
  } catch (const InputError& error) {
    spdlog::error("{}: {}", app.get_name(), error.what());
    // Not every message knows where a value came from.
    if (std::string(error.what()).find("--set") == std::string::npos && !settings_in_use().empty())
      spdlog::error("{}: the case file was read with{}", app.get_name(), settings_as_options());
    return exit_bad_input;
  } catch (const InterruptedError& error) {
    spdlog::error("{}: {}", app.get_name(), error.what());
    return exit_computation_failed;
  } catch (const ComputationError& error) {
    spdlog::error("{}: the computation failed: {}", app.get_name(), error.what());
    return exit_computation_failed;
  } catch (const std::bad_alloc&) {
    spdlog::error("{}: the computation failed: not enough memory", app.get_name());
    return exit_computation_failed;
  } catch (const std::filesystem::filesystem_error& error) {
    spdlog::error("{}: {}", app.get_name(), words_for(error));
    return exit_computation_failed;
  } catch (const std::exception& error) {
    spdlog::error("{}: unexpected error: {}", app.get_name(), error.what());
    return exit_computation_failed;
  }
}

void echo_options(const std::string& title, const std::vector<std::string>& lines, const std::filesystem::path& all) {
  std::vector<std::string> differing;
  for (const auto& line : lines)
    if (line.find("  (default: ") != std::string::npos) differing.push_back(line);
  spdlog::info("{}: {} of {} options differ from their defaults (all of them: {})", title, differing.size(),
               lines.size(), all.string());
  for (const auto& line : differing) spdlog::info("  {}", line);
}

void write_options(const std::filesystem::path& all, const std::string& title, const std::vector<std::string>& lines) {
  std::string text = title + "\n";
  for (const auto& line : lines) text += "  " + line + "\n";
  write_text_file(all.string(), text);
}

void write_text_file(const std::string& path, const std::string& text) {
  require_replaceable(path);
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  const std::filesystem::path temporary = temporary_name(path);
  std::ofstream stream(temporary, std::ios::binary);
  stream << text;
  stream.close();  // also writes what is still held back
  if (!stream) {
    const std::string reason = std::strerror(errno);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw ComputationError(fmt::format("{}: cannot be written: {}", path, reason));
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace tailrun

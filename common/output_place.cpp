#include "common/output_place.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "common/error.hpp"

namespace tailrun {
namespace {

namespace fs = std::filesystem;

std::string kind_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::block:
    case fs::file_type::character:
      return "a device";
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::socket:
      return "a socket";
    default:
      return "no regular file";
  }
}

// Whether a file can be made in `folder` is found out by making one.
void require_writable(const fs::path& folder) {
  const fs::path trial = folder / fmt::format(".tailrun_{}.part", getpid());
  const int descriptor = open(trial.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0 && errno == ENOSPC)
    throw ComputationError(fmt::format("{}: {}", folder.string(), std::strerror(errno)));
  if (descriptor < 0)
    throw InputError(fmt::format("{}: no file can be made in this folder: {}; give another with -o", folder.string(),
                                 std::strerror(errno)));
  close(descriptor);
  unlink(trial.c_str());
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (folder.empty()) throw InputError("-o: an empty name; the folder for the results is required");
  std::error_code failed;
  const auto status = fs::status(folder, failed);
  if (fs::exists(status) && !fs::is_directory(status))
    throw InputError(fmt::format("{}: is {}, but a folder for the results is required", folder.string(),
                                 fs::is_regular_file(status) ? "a file" : kind_of(status.type())));
  fs::create_directories(folder, failed);
  if (failed)
    throw InputError(
        fmt::format("{}: this folder for the results cannot be made: {}", folder.string(), failed.message()));
  require_writable(folder);
}

void require_replaceable(const fs::path& path) {
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(fmt::format("{}: is {}, which is not replaced; give the name of a regular file or of none",
                                 path.string(), kind_of(status.type())));
}

void check_output_file(const fs::path& path) {
  if (path.empty()) throw InputError("-o: an empty name; the file to write is required");
  if (!path.has_filename())
    throw InputError(fmt::format("{}: names a folder, but the file to write is required", path.string()));
  require_replaceable(path);
  check_output_folder(path.has_parent_path() ? path.parent_path() : fs::path("."));
}

void require_no_input(const fs::path& path, const fs::path& input) {
  std::error_code failed;
  if (!path.empty() && !input.empty() && fs::equivalent(path, input, failed))
    throw InputError(fmt::format("{}: is the input {} itself, which is not replaced; give another name", path.string(),
                                 input.string()));
}

void check_output_file(const fs::path& path, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) require_no_input(path, input);
  check_output_file(path);
}

void require_results_apart(const fs::path& folder, const std::vector<std::string>& names,
                           const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs)
    for (const std::string& name : names) {
      std::error_code failed;
      if (!input.empty() && fs::equivalent(folder / name, input, failed))
        throw InputError(
            fmt::format("{}: a result of this name would take the place of the input {}; give another folder with -o, "
                        "or the input another name",
                        (folder / name).string(), input.string()));
    }
}

fs::path temporary_name(const fs::path& path) {
  return path.string() + fmt::format(".{}.part", getpid());
}

std::string words_for(const fs::filesystem_error& error) {
  return fmt::format("{}: {}", error.path1().string(), error.code().message());
}

}  // namespace tailrun

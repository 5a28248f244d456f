#include "common/hdf5_structure.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/hdf5_handle.hpp"

namespace tailrun {
namespace {

constexpr int checksummed_superblock = 2;  // the first version whose headers have checksums
constexpr unsigned longest_probe = 120;    // s, for a file that sends the library round in circles

struct Visit {
  double allowed = 0.0;  // bytes
  std::string problem;   // with the first object that has one
};

bool is_too_large(hid_t space, hid_t type, double allowed) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const double bytes = static_cast<double>(count) * static_cast<double>(H5Tget_size(type));
  H5Sclose(space);
  H5Tclose(type);
  return count < 0 || bytes > allowed;
}

herr_t visit_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  auto& visit = *static_cast<Visit*>(data);
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (attribute < 0)
    visit.problem = fmt::format("attribute '{}' cannot be opened; the file is damaged. Make it again", name);
  else if (is_too_large(H5Aget_space(attribute), H5Aget_type(attribute), visit.allowed))
    visit.problem =
        fmt::format("attribute '{}' claims more data than the file can hold; the file is damaged. Make it again", name);
  return visit.problem.empty() ? 0 : 1;
}

herr_t visit_link(hid_t, const char* name, const H5L_info_t* info, void* data) {
  if (info->type == H5L_TYPE_HARD) return 0;
  static_cast<Visit*>(data)->problem =
      fmt::format("'{}' is {} link; only hard links are allowed, so that everything lies in this file", name,
                  info->type == H5L_TYPE_SOFT       ? "a soft"
                  : info->type == H5L_TYPE_EXTERNAL ? "an external"
                                                    : "a user-defined");
  return 1;
}

std::string problem_of_dataset(hid_t dataset, double allowed) {
  const Hdf5Handle create(H5Dget_create_plist(dataset), H5Pclose);
  if (create < 0) return "cannot be opened; the file is damaged. Make it again";
  if (H5Pget_layout(create) == H5D_VIRTUAL)
    return "is a virtual dataset; its values must be in this file, not in others";
  if (H5Pget_external_count(create) > 0) return "has its values in an external file; they must be in this file";
  if (is_too_large(H5Dget_space(dataset), H5Dget_type(dataset), allowed))
    return "claims more data than the file can hold; the file is damaged. Make it again";
  return {};
}

herr_t visit_object(hid_t file, const char* name, const H5O_info_t* info, void* data) {
  auto& visit = *static_cast<Visit*>(data);
  const bool is_root = std::strcmp(name, ".") == 0;
  const Hdf5Handle object(H5Oopen(file, name, H5P_DEFAULT), H5Oclose);
  if (object < 0) {
    visit.problem = "cannot be opened; the file is damaged. Make it again";
  } else if (info->type == H5O_TYPE_GROUP) {
    if (info->rc > 1)
      visit.problem = fmt::format("is a group with {} names; every group must have one place", info->rc);
    hsize_t from = 0;
    if (visit.problem.empty()) H5Literate(object, H5_INDEX_NAME, H5_ITER_NATIVE, &from, visit_link, data);
  } else if (info->type == H5O_TYPE_DATASET) {
    visit.problem = problem_of_dataset(object, visit.allowed);
  }
  hsize_t from = 0;
  if (visit.problem.empty()) H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, &from, visit_attribute, data);
  if (visit.problem.empty()) return 0;
  visit.problem = fmt::format("/{}: {}", is_root ? "" : name, visit.problem);
  return 1;
}

// Every value of every dataset, as it lies in the file; texts of variable length are left out.
herr_t read_object(hid_t file, const char* name, const H5O_info_t* info, void*) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const Hdf5Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count <= 0 || H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0) return 0;
  std::vector<char> bytes(static_cast<std::size_t>(count) * H5Tget_size(type));
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  return 0;
}

// Of the child process; its fate is the answer.
[[noreturn]] void probe(const std::filesystem::path& path) {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  alarm(longest_probe);
  // It is to end by what happens to it, not in what the program does about it (clears up its files, say).
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGINT, SIGTERM})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  try {
    const Hdf5Handle access(access_without_locks(), H5Pclose);
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
    if (file >= 0) {
      check_structure(file, path);
      H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, read_object, nullptr, H5O_INFO_BASIC);
    }
  } catch (...) {  // a refusal: the caller comes to the same one, with its message
  }
  _exit(0);
}

}  // namespace

int superblock_version(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  char head[9] = {};
  if (!stream.read(head, sizeof head) || std::memcmp(head, "\211HDF\r\n\032\n", 8) != 0) return -1;
  return static_cast<unsigned char>(head[8]);
}

void check_structure(hid_t file, const std::filesystem::path& path) {
  std::error_code ignored;
  Visit visit;
  visit.allowed = 1100.0 * static_cast<double>(std::filesystem::file_size(path, ignored)) + 1e6;
  const herr_t walked = H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit_object, &visit, H5O_INFO_BASIC);
  if (!visit.problem.empty()) throw InputError(fmt::format("{}: {}", path.string(), visit.problem));
  if (walked < 0)
    throw InputError(fmt::format(
        "{}: its groups cannot be walked through; the file is truncated or damaged. Make it again", path.string()));
}

void check_survives_reading(const std::filesystem::path& path) {
  if (superblock_version(path) >= checksummed_superblock) return;
  const pid_t child = fork();
  if (child == 0) probe(path);
  if (child < 0) return;  // no process to be had: the file is read as it is
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError(fmt::format(
        "{}: its headers are damaged: the HDF5 library does not come through them. Make it again", path.string()));
}

}  // namespace tailrun

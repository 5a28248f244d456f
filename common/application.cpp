#include "common/application.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/output_place.hpp"

namespace tailrun {
namespace {

bool is_quiet = false;

}  // namespace

bool quiet() {
  return is_quiet;
}

void set_quiet() {
  is_quiet = true;
  log_from(MessageLevel::warn);
}

std::vector<std::string> differing_options(const std::vector<std::string>& lines) {
  std::vector<std::string> differing;
  for (const auto& line : lines)
    if (line.find("  (default: ") != std::string::npos) differing.push_back(line);
  return differing;
}

void echo_options(const std::string& title, const std::vector<std::string>& lines, const std::filesystem::path& all) {
  const std::vector<std::string> differing = differing_options(lines);
  log_info("{}: {} of {} options differ from their defaults (all of them: {})", title, differing.size(), lines.size(),
           all.string());
  for (const auto& line : differing) log_info("  {}", line);
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

#include "common/text_file.hpp"

#include <fmt/core.h>

#include <fstream>
#include <sstream>
#include <string_view>

#include "common/error.hpp"

namespace tailrun {
namespace {

using namespace std::string_view_literals;

// What a file is that begins with these bytes.
struct Signature {
  std::string_view bytes;
  const char* what;
  const char* advice;
};
constexpr Signature signatures[] = {
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file", ""},
    {"PK\x03\x04"sv, "a zip archive, as spreadsheets are (.xlsx, .ods)", "; save it as CSV"},
    {"\xD0\xCF\x11\xE0"sv, "an old spreadsheet's own format (.xls)", "; save it as CSV"},
    {"\xFF\xFE"sv, "text in UTF-16", "; save it as UTF-8"},
    {"\xFE\xFF"sv, "text in UTF-16", "; save it as UTF-8"},
    {"%PDF"sv, "a PDF", ""},
    {"\x1f\x8b"sv, "a file compressed by gzip", "; unpack it"},
};

}  // namespace

void require_text(const std::filesystem::path& path, std::string_view text, const std::string& what) {
  for (const auto& signature : signatures)
    if (text.starts_with(signature.bytes))
      throw InputError(fmt::format("{}: found {}, but {} in plain text is required here{}", path.string(),
                                   signature.what, what, signature.advice));
  if (const auto zero = text.find('\0'); zero != std::string_view::npos)
    throw InputError(fmt::format("{}: found a binary file (byte {} is 0), but {} in plain text is required here",
                                 path.string(), zero, what));
}

std::vector<std::string> read_lines(const std::filesystem::path& path, const std::string& what) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(fmt::format("{}: is a folder, but {} is required", path.string(), what));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: no such file, or it cannot be read", path.string()));
  std::ostringstream buffer;
  buffer << stream.rdbuf();
  const std::string all = buffer.str();
  std::string_view text = all;
  require_text(path, text, what);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.empty()) throw InputError(fmt::format("{}: empty, but {} is required", path.string(), what));
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    lines.emplace_back(text.substr(0, end));
    const std::size_t ends = text.substr(end).starts_with("\r\n") ? 2 : 1;
    text.remove_prefix(std::min(end + ends, text.size()));
  }
  return lines;
}

}  // namespace tailrun

// Tables and motions as programs of others write them: text, whatever ends its lines.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tailrun {

// Throws InputError naming `path` when `text`, its bytes, is no text: with what it is where the first bytes tell (HDF5,
// a spreadsheet's own format, UTF-16). `what` is for messages: "a table", "a motion".
void require_text(const std::filesystem::path& path, std::string_view text, const std::string& what);

// The lines of a text file, without their ends: LF, CR LF or (old spreadsheets) CR alone. A byte order mark of UTF-8 is
// skipped. Throws InputError: missing, a folder, empty, and as require_text does.
std::vector<std::string> read_lines(const std::filesystem::path& path, const std::string& what);

}  // namespace tailrun

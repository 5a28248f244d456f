// JSON from outside: parsed by the library, but checked for what it lets pass and with its messages in our words.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tailrun {

// Throws InputError naming `path` and the place (line and column, or JSON pointer): not JSON, not UTF-8, a key twice in
// one object, a number beyond the range of double, nested deeper than 100 levels. Comments are allowed.
nlohmann::ordered_json parse_json(const std::filesystem::path& path, const std::string& text);

// What one of the programs has written into a file's attribute; null when it is not JSON.
nlohmann::ordered_json json_or_null(const std::string& text);

// The library's dump(), compiled once: `indent` spaces a level, on one line without. Bytes that are not UTF-8, as file
// names may hold, become U+FFFD: no result is lost for a name.
std::string text_of_json(const nlohmann::ordered_json& json, int indent = -1);

bool is_utf8(const std::string& text);

}  // namespace tailrun

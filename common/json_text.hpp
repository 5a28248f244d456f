// JSON from outside: parsed by the library, but checked for what it lets pass and with its messages in our words.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace tailrun {

// Throws InputError naming `path` and the place (line and column, or JSON pointer): not JSON, not UTF-8, a key twice in
// one object, a number beyond the range of double, nested deeper than 100 levels. Comments are allowed.
nlohmann::ordered_json parse_json(const std::filesystem::path& path, const std::string& text);

}  // namespace tailrun

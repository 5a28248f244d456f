#include "fem_stage/mesh/geo_commands.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

namespace fs = std::filesystem;

struct Token {
  std::string text;     // a word, a string without its quotes, or one character
  bool string = false;  // quoted
  std::size_t line = 1;
};

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// Every word of the text, in strings and comments, too, and the signs that tell a redirection.
std::vector<Token> all_words(const std::string& text) {
  std::vector<Token> tokens;
  std::size_t line = 1;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\n') ++line;
    if (!is_word(text[i])) {
      if (std::string_view(")>;").find(text[i]) != std::string_view::npos)
        tokens.push_back({std::string(1, text[i]), false, line});
      ++i;
      continue;
    }
    Token token{"", false, line};
    for (; i < text.size() && is_word(text[i]); ++i) token.text += text[i];
    tokens.push_back(token);
  }
  return tokens;
}

// Words, strings and other characters; comments left out. Where a string runs over its line or has a backslash before a
// quote, it may end elsewhere for gmsh than here, and what is hidden in it cannot be told: then every word counts.
std::vector<Token> tokens_of(const std::string& text) {
  std::vector<Token> tokens;
  std::size_t line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      const std::size_t end = std::min(text.find("*/", i + 2), text.size());
      line += static_cast<std::size_t>(
          std::count(text.begin() + static_cast<long>(i), text.begin() + static_cast<long>(end), '\n'));
      i = std::min(end + 2, text.size());
    } else if (c == '"' || c == '\'') {
      Token token{"", true, line};
      for (++i; i < text.size() && text[i] != c && text[i] != '\n'; ++i) token.text += text[i];
      if (i >= text.size() || text[i] == '\n' || (!token.text.empty() && token.text.back() == '\\'))
        return all_words(text);
      ++i;
      tokens.push_back(token);
    } else if (is_word(c)) {
      Token token{"", false, line};
      for (; i < text.size() && is_word(text[i]); ++i) token.text += text[i];
      tokens.push_back(token);
    } else {
      if (!std::isspace(static_cast<unsigned char>(c))) tokens.push_back({std::string(1, c), false, line});
      ++i;
    }
  }
  return tokens;
}

[[noreturn]] void refuse(const fs::path& file, const Token& token, const std::string& why) {
  throw InputError(
      fmt::format("{}: line {}: '{}' {}. fem_stage does not let a case's geometry do that; if you trust it, give "
                  "--trust-geometry",
                  file.string(), token.line, token.text, why));
}

// Whether a word is a command: not a member (Print.Background), not a variable that is assigned.
bool is_command(const std::vector<Token>& tokens, std::size_t i) {
  const bool member = i > 0 && !tokens[i - 1].string && tokens[i - 1].text == ".";
  const std::string next = i + 1 < tokens.size() && !tokens[i + 1].string ? tokens[i + 1].text : "";
  return !member && next != "." && next != "=";
}

void check(const fs::path& file, std::set<fs::path>& seen) {
  std::error_code failed;  // a name that cannot be one, which gmsh will not find either
  const fs::path whole = fs::weakly_canonical(file, failed);
  if (failed || !seen.insert(whole).second) return;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || !fs::is_regular_file(file, failed)) return;  // gmsh says so
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  // Where a text ends for gmsh and goes on here, what is hidden behind it cannot be told.
  if (const auto at = text.find('\0'); at != std::string::npos)
    throw InputError(fmt::format("{}: line {}: a byte 0, which no geometry has: it is no text, or damaged",
                                 file.string(),
                                 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n')));
  const auto tokens = tokens_of(text);
  constexpr std::array programs = {"SystemCall", "NonBlockingSystemCall", "System", "OnelabRun", "ExternalProcess"};
  constexpr std::array files = {"Save", "Print", "CreateDir", "Plugin"};
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    // The name of a field ("Field[1] = ExternalProcess;") and the options of solvers are no commands, yet start
    // programs.
    if (!token.string && token.text == "ExternalProcess") refuse(file, token, "starts another program");
    if (token.string || !is_command(tokens, i)) continue;
    if (std::find(programs.begin(), programs.end(), token.text) != programs.end())
      refuse(file, token, "starts another program");
    if (std::find(files.begin(), files.end(), token.text) != files.end()) refuse(file, token, "writes files");
    if (token.text == "Parse") refuse(file, token, "makes commands out of text");
    if (token.text == "Printf" || token.text == "Error" || token.text == "Warning") {
      for (std::size_t k = i + 1; k < tokens.size() && (tokens[k].string || tokens[k].text != ";"); ++k)
        if (!tokens[k].string && tokens[k].text == ">" && !tokens[k - 1].string && tokens[k - 1].text == ")")
          refuse(file, token, "writes to a file");
    }
    const bool merges = token.text.rfind("Merge", 0) == 0;
    if (token.text == "Include" || merges || token.text == "ShapeFromFile") {
      const std::size_t name = i + 1 + (i + 1 < tokens.size() && tokens[i + 1].text == "(");
      if (name >= tokens.size() || !tokens[name].string)
        refuse(file, token, "reads a file whose name is made by the geometry");
      check(file.parent_path() / tokens[name].text, seen);
    }
  }
}

}  // namespace

void refuse_commands(const fs::path& geometry) {
  std::set<fs::path> seen;
  check(geometry, seen);
  check(geometry.string() + ".opt", seen);  // gmsh reads it beside the geometry
}

}  // namespace tailrun::fem

#include "common/case_file.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

#include "common/case_file_state.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace tailrun {

bool Range::contains(double value) const {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto bound = [](double value) {
    return std::isfinite(value) ? fmt::format("{:g}", value) : value < 0 ? "-inf" : "inf";
  };
  return fmt::format("{}{}, {}{}", low_open || !std::isfinite(low) ? '(' : '[', bound(low), bound(high),
                     high_open || !std::isfinite(high) ? ')' : ']');
}

CaseFile::CaseFile(const std::filesystem::path& path) : state_(std::make_shared<State>()) {
  state_->path = path;
  state_->inputs = {path};
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(fmt::format("{}: is a folder, but a case file (JSON) is required", path.string()));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: no such case file, or it cannot be read", path.string()));
  std::ostringstream text;
  text << stream.rdbuf();
  state_->text = text.str();
  require_text(path, state_->text, "a case file (JSON)");
  state_->json = parse_json(path, state_->text);
  if (!state_->json.is_object())
    throw InputError(
        fmt::format("{}: the case file must be a JSON object, found {}", path.string(), kind(state_->json)));
  state_->settings = settings_in_use();
  if (state_->settings.empty()) return;
  apply_settings(state_->json, state_->settings, path);
  state_->text = effective_text(state_->json, state_->settings);
}

CaseFile::~CaseFile() = default;
CaseFile::CaseFile(CaseFile&&) noexcept = default;

CaseNode CaseFile::root() const {
  return CaseNode(state_, &state_->json, "");
}
const std::filesystem::path& CaseFile::path() const {
  return state_->path;
}
const std::string& CaseFile::text() const {
  return state_->text;
}
std::vector<std::string> CaseFile::echo() const {
  return state_->echo;
}
std::vector<std::filesystem::path> CaseFile::inputs() const {
  return state_->inputs;
}

void CaseFile::finish() const {
  for (const auto& [pointer, object] : state_->visited) {
    const auto& known = state_->known[pointer];
    for (const auto& [key, value] : object->items()) {
      if (known.contains(key)) continue;
      const std::string origin = state_->origin(child(pointer, key));
      std::vector<std::string> unused;  // in the file; a setting may well be meant to replace what is there
      for (const auto& candidate : known)
        if (!origin.empty() || !object->contains(candidate)) unused.push_back(candidate);
      throw InputError(fmt::format("{}: {}{}: unknown key '{}'.{} Allowed here: {}", state_->path.string(),
                                   child(pointer, key), origin, key, did_you_mean(key, unused),
                                   joined({known.begin(), known.end()})));
    }
  }
}

}  // namespace tailrun

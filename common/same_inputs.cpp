#include "common/same_inputs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/log.hpp"

namespace tailrun {
namespace {

// What the case file with this sum says, without comments and spaces; null if the sum is that of another input.
nlohmann::ordered_json content_of(const std::vector<std::string>& texts, const std::string& sum,
                                  const std::filesystem::path& path) {
  for (const auto& text : texts)
    if (sha256_of_text(text) == sum) return parse_json(path, text);
  return nullptr;
}

}  // namespace

void check_same_inputs(const Hdf5Reader& file, const Provenance& provenance) {
  const std::string group = "/tailrun/provenance";
  const auto names = file.texts(group + "/input_names"), sums = file.texts(group + "/input_sha256");
  std::vector<std::string> texts_now;
  for (const auto& [name, text] : provenance.texts) texts_now.push_back(text);
  for (std::size_t k = 0; k < std::max(sums.size(), provenance.sha256.size()); ++k) {
    std::string place;
    if (k < sums.size() && k < provenance.sha256.size()) {
      if (sums[k] == provenance.sha256[k].second) continue;
      const auto before = content_of(file.texts(group + "/case_texts"), sums[k], file.path());
      const auto after = content_of(texts_now, provenance.sha256[k].second, provenance.sha256[k].first);
      if (before.is_object() && after.is_object()) {
        if (before.dump() == after.dump()) continue;
        const auto changes = nlohmann::ordered_json::diff(before, after);
        if (!changes.empty()) place = fmt::format(" (first at {})", changes.front().at("path").get<std::string>());
      }
    }
    const std::string now = k < provenance.sha256.size() ? provenance.sha256[k].first : "none";
    file.fail(group, fmt::format("input {} was '{}' when this checkpoint was written and is '{}' now, or its content, "
                                 "with what --set changes in it, is another{}; a run can only go on with the input it "
                                 "began with (without --resume it starts anew)",
                                 k + 1, k < names.size() ? names[k] : "none", now, place));
  }
  if (file.text_attribute(group, "version") != version())
    log_warn("{} was written by version {} of the program, this is {}: results may differ in the last digits",
             file.path().string(), file.text_attribute(group, "version"), version());
}

}  // namespace tailrun

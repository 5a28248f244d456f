#include "common/plain_names.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "common/json_text.hpp"

namespace tailrun {
namespace {

bool is_control(unsigned char c) {
  return c < 0x20 || c == 0x7f;
}

std::string fault_of_all(const std::string& name) {
  if (name.empty()) return "is empty";
  if (std::any_of(name.begin(), name.end(), is_control)) return "has a line break or another control character";
  return is_utf8(name) ? "" : "has a character that is not UTF-8";
}

void require_none(const CaseNode& node, const std::string& key, const std::string& name, const std::string& fault,
                  const std::string& use) {
  if (!fault.empty())
    node.fail(key, fmt::format("the name {} {}, but it is part of {}; give another", shown_name(name), fault, use));
}

}  // namespace

std::string fault_as_column(const std::string& name) {
  if (const std::string fault = fault_of_all(name); !fault.empty()) return fault;
  if (name.find(',') != std::string::npos) return "has a comma";
  if (name.find('"') != std::string::npos) return "has a double quote";
  return name.front() == ' ' || name.back() == ' ' ? "has a blank at an end" : "";
}

std::string fault_as_dataset(const std::string& name) {
  if (const std::string fault = fault_of_all(name); !fault.empty()) return fault;
  if (name.find('/') != std::string::npos) return "has a slash";
  return name == "." ? "is a dot alone" : "";
}

void require_column_name(const CaseNode& node, const std::string& key, const std::string& name,
                         const std::string& use) {
  require_none(node, key, name, fault_as_column(name), use);
}

void require_dataset_name(const CaseNode& node, const std::string& key, const std::string& name,
                          const std::string& use) {
  require_none(node, key, name, fault_as_dataset(name), use);
}

std::string shown_name(const std::string& name) {
  return text_of_json(nlohmann::ordered_json(name));
}

}  // namespace tailrun

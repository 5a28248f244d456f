#include "common/warnings.hpp"

#include <algorithm>

#include "common/log.hpp"

namespace tailrun {
namespace {

std::vector<std::string>& kept() {
  static std::vector<std::string> list;
  return list;
}

}  // namespace

void add_warning(const std::string& text) {
  auto& list = kept();
  if (std::find(list.begin(), list.end(), text) != list.end()) return;
  list.push_back(text);
  log_warn("warning: {}", text);
}

const std::vector<std::string>& warnings() {
  return kept();
}

void forget_warnings() {
  kept().clear();
}

}  // namespace tailrun

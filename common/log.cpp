#include "common/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace tailrun {
namespace {

spdlog::level::level_enum in_spdlog(MessageLevel level) {
  switch (level) {
    case MessageLevel::debug:
      return spdlog::level::debug;
    case MessageLevel::info:
      return spdlog::level::info;
    case MessageLevel::warn:
      return spdlog::level::warn;
    case MessageLevel::error:
      break;
  }
  return spdlog::level::err;
}

}  // namespace

bool is_logged(MessageLevel level) {
  return spdlog::should_log(in_spdlog(level));
}

void log_text(MessageLevel level, const std::string& text) {
  spdlog::log(in_spdlog(level), spdlog::string_view_t(text));
}

void log_plain_lines() {
  auto logger = spdlog::stderr_logger_st("tailrun");
  logger->set_pattern("%v");
  spdlog::set_default_logger(logger);
}

void log_from(MessageLevel level) {
  spdlog::set_level(in_spdlog(level));
}

}  // namespace tailrun

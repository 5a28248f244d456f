// Messages on standard error, through spdlog. Its templates format in every file that uses them, which costs the
// compiler two seconds a file; here they are compiled once.
#pragma once

#include <fmt/core.h>

#include <string>
#include <utility>

namespace tailrun {

enum class MessageLevel { debug, info, warn, error };

// Whether messages of that level are shown (--quiet, --verbose).
bool is_logged(MessageLevel level);
void log_text(MessageLevel level, const std::string& text);

// `format` and what follows as fmt::format has them.
template <class... T>
void log_debug(fmt::format_string<T...> format, T&&... values) {
  if (is_logged(MessageLevel::debug)) log_text(MessageLevel::debug, fmt::format(format, std::forward<T>(values)...));
}
template <class... T>
void log_info(fmt::format_string<T...> format, T&&... values) {
  log_text(MessageLevel::info, fmt::format(format, std::forward<T>(values)...));
}
template <class... T>
void log_warn(fmt::format_string<T...> format, T&&... values) {
  log_text(MessageLevel::warn, fmt::format(format, std::forward<T>(values)...));
}
template <class... T>
void log_error(fmt::format_string<T...> format, T&&... values) {
  log_text(MessageLevel::error, fmt::format(format, std::forward<T>(values)...));
}

// To be called once, before the first message: plain lines on standard error.
void log_plain_lines();
void log_from(MessageLevel level);

}  // namespace tailrun

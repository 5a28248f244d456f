#include "common/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/application.hpp"

namespace tailrun {
namespace {

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  const long minutes = static_cast<long>(seconds / 60.0);
  if (minutes < 100)
    return fmt::format("{} min {:02d} s", minutes, static_cast<int>(seconds - 60.0 * static_cast<double>(minutes)));
  return fmt::format("{} h {:02d} min", minutes / 60, minutes % 60);
}

}  // namespace

Progress::Progress(std::string phase, double total, std::string unit)
    : phase_(std::move(phase)),
      unit_(std::move(unit)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (!finished_ && !quiet() && isatty(STDERR_FILENO)) std::fputc('\n', stderr);
}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::update(double done, long steps, const std::string& note) {
  done_ = done;
  steps_ = steps;
  if (quiet() || !isatty(STDERR_FILENO)) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const double seconds = elapsed();
  const int width = 24, filled = static_cast<int>(fraction * width);
  const std::string left = fraction > 0.001 ? duration(seconds * (1.0 - fraction) / fraction) : "?";
  const std::string line = fmt::format(
      "{:<10} [{}{}] {:3.0f} %  {:.3g}/{:.3g} {}  {:.0f} steps/s  {} left  {}", phase_,
      std::string(static_cast<std::size_t>(filled), '#'), std::string(static_cast<std::size_t>(width - filled), '.'),
      100.0 * fraction, done, total_, unit_, static_cast<double>(steps) / std::max(seconds, 1e-9), left, note);
  std::fputs(("\r\033[K" + line).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::finish(const std::string& note) {
  finished_ = true;
  if (quiet()) return;
  const double seconds = elapsed();
  const std::string rate =
      steps_ ? fmt::format(", {} steps, {:.0f} steps/s", steps_, static_cast<double>(steps_) / std::max(seconds, 1e-9))
             : "";
  if (isatty(STDERR_FILENO)) std::fputs("\r\033[K", stderr);
  std::fputs(fmt::format("{}: {:.4g} {} in {}{}{}{}\n", phase_, done_, unit_, duration(seconds), rate,
                         note.empty() ? "" : ", ", note)
                 .c_str(),
             stderr);
}

}  // namespace tailrun

#include "common/motion.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <regex>
#include <sstream>

#include "common/error.hpp"

namespace tailrun {
namespace {

constexpr double standard_gravity = 9.81;  // m/s2; the value that the reference motions were made with

std::vector<double> integral(const std::vector<double>& rate, double dt) {
  std::vector<double> sum(rate.size(), 0.0);
  for (std::size_t i = 1; i < rate.size(); ++i) sum[i] = sum[i - 1] + 0.5 * dt * (rate[i - 1] + rate[i]);
  return sum;
}

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: no such motion file, or it cannot be read", path.string()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
    lines.push_back(line);
  }
  return lines;
}

double number_in(const std::filesystem::path& path, std::size_t line, const std::string& word) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(word, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != word.size() || !std::isfinite(value))
    throw InputError(fmt::format("{}: line {}: '{}' is not a number", path.string(), line + 1, word));
  return value;
}

}  // namespace

double Motion::duration() const {
  return acceleration.empty() ? 0.0 : time_step * static_cast<double>(acceleration.size() - 1);
}

double Motion::acceleration_at(double t) const {
  if (t < 0.0 || t > duration() || acceleration.size() < 2) return 0.0;
  const std::size_t i = std::min(static_cast<std::size_t>(t / time_step), acceleration.size() - 2);
  const double s = t / time_step - static_cast<double>(i);
  return (1.0 - s) * acceleration[i] + s * acceleration[i + 1];
}

double Motion::velocity_at(double t) const {
  if (t <= 0.0 || acceleration.size() < 2) return 0.0;
  if (t >= duration()) return velocity.back();
  const std::size_t i = std::min(static_cast<std::size_t>(t / time_step), acceleration.size() - 2);
  const double tau = t - time_step * static_cast<double>(i);
  const double slope = (acceleration[i + 1] - acceleration[i]) / time_step;
  return velocity[i] + acceleration[i] * tau + 0.5 * slope * tau * tau;
}

double Motion::peak_acceleration() const {
  double peak = 0.0;
  for (const double a : acceleration) peak = std::max(peak, std::abs(a));
  return peak;
}

double Motion::peak_velocity() const {
  double peak = 0.0;
  for (const double v : velocity) peak = std::max(peak, std::abs(v));
  return peak;
}

double Motion::arias_intensity() const {
  std::vector<double> squares(acceleration.size());
  std::transform(acceleration.begin(), acceleration.end(), squares.begin(), [](double a) { return a * a; });
  const auto sum = integral(squares, time_step);
  return sum.empty() ? 0.0 : std::numbers::pi / (2.0 * standard_gravity) * sum.back();
}

std::pair<double, double> Motion::significant_duration(double from, double to) const {
  std::vector<double> squares(acceleration.size());
  std::transform(acceleration.begin(), acceleration.end(), squares.begin(), [](double a) { return a * a; });
  const auto sum = integral(squares, time_step);
  if (sum.empty() || sum.back() <= 0.0) return {0.0, 0.0};
  const auto arrival = [&](double share) {
    const auto it = std::lower_bound(sum.begin(), sum.end(), share * sum.back());
    return time_step * static_cast<double>(it - sum.begin());
  };
  return {arrival(from), arrival(to)};
}

Motion read_at2(const std::filesystem::path& path) {
  const auto lines = lines_of(path);
  if (lines.size() < 5)
    throw InputError(
        fmt::format("{}: an AT2 file has four header lines and values, found {} lines", path.string(), lines.size()));
  static const std::regex modern(R"(NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([0-9.Ee+-]+))", std::regex::icase);
  static const std::regex old(R"(^\s*(\d+)\s+([0-9.Ee+-]+)\s+NPTS)", std::regex::icase);
  std::smatch match;
  std::string header = lines[3];
  if (!std::regex_search(header, match, modern) && !std::regex_search(header, match, old))
    throw InputError(fmt::format("{}: line 4: found '{}', but 'NPTS= n, DT= s SEC' or 'n dt NPTS, DT' is required",
                                 path.string(), header));
  Motion motion;
  motion.name = path.filename().string();
  const std::size_t count = static_cast<std::size_t>(std::stoul(match[1]));
  motion.time_step = number_in(path, 3, match[2]);
  if (motion.time_step <= 0.0)
    throw InputError(fmt::format("{}: line 4: the time step must be positive", path.string()));
  for (std::size_t i = 4; i < lines.size(); ++i) {
    std::istringstream words(lines[i]);
    for (std::string word; words >> word;) motion.acceleration.push_back(standard_gravity * number_in(path, i, word));
  }
  if (motion.acceleration.size() < count)
    throw InputError(fmt::format("{}: line 4 promises {} values, but only {} follow; the file is cut short",
                                 path.string(), count, motion.acceleration.size()));
  if (motion.acceleration.size() > count) {
    spdlog::warn("{}: line 4 promises {} values, {} follow; the surplus is ignored", path.string(), count,
                 motion.acceleration.size());
    motion.acceleration.resize(count);
  }
  motion.velocity = integral(motion.acceleration, motion.time_step);
  return motion;
}

Motion read_motion_csv(const std::filesystem::path& path) {
  Motion motion;
  motion.name = path.filename().string();
  std::vector<double> times;
  const auto lines = lines_of(path);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string line = lines[i];
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string time, acceleration;
    if (!(words >> time >> acceleration)) continue;
    const bool header = i == 0 && time.find_first_not_of("0123456789.eE+-") != std::string::npos;
    if (header) continue;
    times.push_back(number_in(path, i, time));
    motion.acceleration.push_back(number_in(path, i, acceleration));
  }
  if (times.size() < 2)
    throw InputError(fmt::format("{}: at least two rows 'time [s], acceleration [m/s2]' are required", path.string()));
  motion.time_step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double expected = times.front() + motion.time_step * static_cast<double>(i);
    if (motion.time_step <= 0.0 || std::abs(times[i] - expected) > 0.01 * motion.time_step)
      throw InputError(fmt::format("{}: row {}: time {:g} s, but a uniform time step ({:g} s) is required",
                                   path.string(), i + 1, times[i], motion.time_step));
  }
  motion.velocity = integral(motion.acceleration, motion.time_step);
  return motion;
}

Motion read_motion(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".at2") return read_at2(path);
  if (extension == ".csv" || extension == ".txt") return read_motion_csv(path);
  throw InputError(fmt::format("{}: a motion is a PEER .AT2 file or a two-column .csv, found extension '{}'",
                               path.string(), extension));
}

Motion scaled_to_peak(Motion motion, double peak) {
  const double now = motion.peak_acceleration();
  if (now <= 0.0) throw InputError(fmt::format("{}: the motion is zero and cannot be scaled", motion.name));
  for (double& a : motion.acceleration) a *= peak / now;
  for (double& v : motion.velocity) v *= peak / now;
  return motion;
}

}  // namespace tailrun

#include "fem_stage/boundary/time_history.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "common/error.hpp"
#include "common/motion_units.hpp"
#include "common/number_text.hpp"
#include "common/text_file.hpp"

namespace tailrun::fem {

TimeHistory TimeHistory::ramp(double start, double duration) {
  TimeHistory out(Kind::ramp, start);
  out.duration_ = duration;
  return out;
}

TimeHistory TimeHistory::ricker(double frequency, double delay) {
  TimeHistory out(Kind::ricker, delay);
  out.frequency_ = frequency;
  return out;
}

TimeHistory TimeHistory::sine(double frequency, double start) {
  TimeHistory out(Kind::sine, start);
  out.frequency_ = frequency;
  return out;
}

TimeHistory TimeHistory::table(const std::filesystem::path& path) {
  TimeHistory out(Kind::table, 0.0);
  int row = 0;
  double to_seconds = 1.0;
  for (std::string& line : read_lines(path, "a table 'time [s], factor'")) {
    ++row;
    const std::string found = line;
    for (char& c : line)
      if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    std::istringstream words(line);
    std::string first, second, third;
    words >> first >> second >> third;
    const auto at = number_of(first), value = number_of(second);
    if (out.time_.empty() && row == 1 && !at) {  // a header, which may say the unit of time
      const ColumnUnit unit = column_unit(found.substr(0, found.find_first_of(",;\t\r")));
      to_seconds = unit.time.value_or(1.0);
      if (!unit.unknown.empty())
        throw InputError(
            fmt::format("{}: row 1: '{}' is no unit of time: s or ms is required", path.string(), unit.unknown));
      continue;
    }
    if (!at || !value || !third.empty())
      throw InputError(
          fmt::format("{}: row {}: found '{}', but 'time [s], factor' is required", path.string(), row, line));
    const double time = to_seconds * *at, factor = *value;
    if (!out.time_.empty() && time <= out.time_.back())
      throw InputError(fmt::format("{}: row {}: time {:g} s does not ascend (the row before has {:g} s)", path.string(),
                                   row, time, out.time_.back()));
    out.time_.push_back(time);
    out.factor_.push_back(factor);
  }
  if (out.time_.size() < 2)
    throw InputError(fmt::format("{}: at least two rows 'time [s], factor' are required", path.string()));
  return out;
}

double TimeHistory::at(double time) const {
  switch (kind_) {
    case Kind::constant:
      return 1.0;
    case Kind::ramp:
      if (time <= start_) return duration_ == 0.0 && time == start_ ? 1.0 : 0.0;
      return time >= start_ + duration_ ? 1.0 : (time - start_) / duration_;
    case Kind::ricker: {
      const double root = std::numbers::pi * frequency_ * (time - start_), a = root * root;
      return (1.0 - 2.0 * a) * std::exp(-a);
    }
    case Kind::sine:
      return time <= start_ ? 0.0 : std::sin(2.0 * std::numbers::pi * frequency_ * (time - start_));
    case Kind::table:
      break;
  }
  if (time <= time_.front()) return factor_.front();
  if (time >= time_.back()) return factor_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), time) - time_.begin());
  const double s = (time - time_[i - 1]) / (time_[i] - time_[i - 1]);
  return factor_[i - 1] + s * (factor_[i] - factor_[i - 1]);
}

double TimeHistory::largest() const {
  if (kind_ != Kind::table) return 1.0;
  double largest = 0.0;
  for (const double f : factor_) largest = std::max(largest, std::abs(f));
  return largest;
}

}  // namespace tailrun::fem

// Numbers of the series' CSV files.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <string>

namespace tailrun::mpm {

// A comma and the number with so many significant digits; nothing after the comma where the number is not known.
inline std::string csv_cell(double value, int digits) {
  return std::isnan(value) ? "," : fmt::format(",{:.{}g}", value, digits);
}

}  // namespace tailrun::mpm

// Units of ground motions as people write them: "UNITS OF CM/SEC**2", "acceleration [gal]", "a_m_s2", "Time (ms)". A
// unit is read or refused, never ignored.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tailrun {

enum class MotionQuantity { acceleration, velocity, displacement };

struct MotionUnit {
  MotionQuantity quantity = MotionQuantity::acceleration;
  double factor = 1.0;  // to m/s2, m/s, m
  std::string text;     // as it was found
};

constexpr double standard_gravity = 9.81;  // m/s2; the value that the reference motions were made with

// "m/s2, cm/s2, mm/s2, gal, g, mg, %g, ft/s2, in/s2"
extern const char* const known_acceleration_units;

// The unit that `text` begins with (or, with `whole`, is).
std::optional<MotionUnit> motion_unit(std::string_view text, bool whole);

// s, sec, ms, msec ... as a factor to seconds; nothing when it is no unit of time.
std::optional<double> time_unit(std::string_view word);

// What a line of free text says about the values: a unit after "UNITS OF" and the like, or the quantity alone.
// `unknown` is what follows "UNITS OF" when that is no unit of a motion.
struct StatedUnit {
  std::optional<MotionUnit> unit;
  std::string unknown;
  bool after_units_word = false;
};
StatedUnit unit_stated_in(const std::string& line);

// The unit in the name of a table's column: in brackets, as suffix ("_cm_s2"), as last word, or the whole name.
// `unknown` is what stands in brackets when that is no unit.
struct ColumnUnit {
  std::optional<MotionUnit> unit;
  std::optional<double> time;  // s
  std::string unknown;
};
ColumnUnit column_unit(const std::string& name);

}  // namespace tailrun

// Ground motions: PEER AT2 files and two-column CSV (read in motion_file.cpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tailrun {

struct Motion {
  std::string name;
  double time_step = 0.0;            // s
  std::vector<double> acceleration;  // m/s2, at 0, dt, 2 dt ...
  std::vector<double> velocity;      // m/s, trapezoidal integral of the acceleration

  void integrate();                        // makes the velocity
  double duration() const;                 // s
  double acceleration_at(double t) const;  // m/s2, linear between points, 0 outside
  double velocity_at(double t) const;  // m/s, exact integral of the linear acceleration; the last value after the end
  double peak_acceleration() const;    // m/s2
  double peak_velocity() const;        // m/s
  double arias_intensity() const;      // m/s
  // Times (s) between which the given share of the Arias intensity arrives, e.g. (0.05, 0.95).
  std::pair<double, double> significant_duration(double from, double to) const;
  double arias_share_after(double t) const;  // 1, of the Arias intensity; 0 for a motion that is zero
};

// PEER AT2. The line with the count and the time step is found by its form ("NPTS=  1559, DT= .02000 SEC",
// "4164    0.0100    NPTS, DT"; the step in s or ms) after three or more lines of text, which may say the unit ("UNITS
// OF G", "CM/SEC**2" ...); without one the values are in g (9.81 m/s2, as the reference data use). Exponents may be
// Fortran's D, columns may be glued, line ends "\r\r\n". A count that disagrees is an error when values are missing and
// a warning when there are more. Throws InputError: another unit, velocities, displacements.
Motion read_at2(const std::filesystem::path& path);

// Two columns, time and acceleration, separated by commas, semicolons, tabs or blanks, after header or comment lines.
// Names of the columns may say the unit ("time [ms]", "a_cm_s2", "acc (g)"); s and m/s2 without. The time step must be
// uniform; a start other than 0 is moved there, with a warning. Throws InputError: empty values, more columns, other
// units.
Motion read_motion_csv(const std::filesystem::path& path);

// By extension (.AT2/.at2 or .csv/.txt). Throws InputError.
Motion read_motion(const std::filesystem::path& path);

// Scaled so that the peak acceleration is `peak` (m/s2).
Motion scaled_to_peak(Motion motion, double peak);

// Warnings (common/warnings.hpp) about what can be computed but is hardly meant: a peak that looks like g or a factor,
// a baseline that drifts, a step of the computation (s) longer than the record's. `recorded_peak` m/s2, before scaling.
void warn_about_motion(const Motion& motion, double recorded_peak, double step, double duration);

// A run that begins `start` seconds into the record: warns when the record, or nearly all of its shaking, is over by
// then.
void warn_about_late_start(const Motion& motion, double start);

}  // namespace tailrun

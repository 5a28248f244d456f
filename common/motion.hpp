// Ground motions: PEER AT2 files and two-column CSV.
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

  double duration() const;                 // s
  double acceleration_at(double t) const;  // m/s2, linear between points, 0 outside
  double velocity_at(double t) const;  // m/s, exact integral of the linear acceleration; the last value after the end
  double peak_acceleration() const;    // m/s2
  double peak_velocity() const;        // m/s
  double arias_intensity() const;      // m/s
  // Times (s) between which the given share of the Arias intensity arrives, e.g. (0.05, 0.95).
  std::pair<double, double> significant_duration(double from, double to) const;
};

// PEER AT2, in g: header forms "NPTS=  1559, DT= .02000 SEC", "NPTS=   2000, DT=   .0200 SEC," and
// "4164    0.0100    NPTS, DT"; free text in lines 1 to 3; "\r\r\n" line ends; a count that disagrees is an error
// when values are missing and a warning when there are more. `standard_gravity` 9.81 m/s2 as the reference data use.
Motion read_at2(const std::filesystem::path& path);

// Columns time (s), acceleration (m/s2), comma or blank separated, one header line allowed; the time step must be
// uniform.
Motion read_motion_csv(const std::filesystem::path& path);

// By extension (.AT2/.at2 or .csv/.txt). Throws InputError.
Motion read_motion(const std::filesystem::path& path);

// Scaled so that the peak acceleration is `peak` (m/s2).
Motion scaled_to_peak(Motion motion, double peak);

}  // namespace tailrun

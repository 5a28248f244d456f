// What can be computed with a motion but is hardly meant.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/motion.hpp"
#include "common/motion_units.hpp"
#include "common/warnings.hpp"

namespace tailrun {

void warn_about_motion(const Motion& motion, double recorded_peak, double step, double duration) {
  const double peak = motion.peak_acceleration(), factor = recorded_peak > 0.0 ? peak / recorded_peak : 1.0;
  const double end = motion.duration();
  constexpr double impossible = 1e4;  // m/s2, a thousand g
  if (!(peak < impossible))
    throw InputError(
        fmt::format("{}: the peak acceleration is {:.4g} m/s2, but at most {:g} m/s2 are allowed: is the unit right?",
                    motion.name, peak, impossible));
  if (peak == 0.0) add_warning(fmt::format("{}: every acceleration is zero", motion.name));
  // Strong motions peak between about 0.5 and 20 m/s2; nobody scales one by more than ten either way.
  if (factor != 1.0 && peak < 1.0 && (factor < 0.6 || peak < 0.6))
    add_warning(fmt::format(
        "peak_acceleration {:g} m/s2 is {:.2g} g; if {:g} g is meant, write {:.4g}. The record {} has a peak "
        "of {:.3g} m/s2",
        peak, peak / standard_gravity, peak, peak * standard_gravity, motion.name, recorded_peak));
  else if (factor > 10.0 || factor < 0.1)
    add_warning(
        fmt::format("peak_acceleration {:g} m/s2 scales {} by {:.3g}: is the unit right? It has a peak of {:.3g} "
                    "m/s2",
                    peak, motion.name, factor, recorded_peak));
  if (peak > 3.0 * standard_gravity)
    add_warning(fmt::format("{}: the peak acceleration is {:.4g} m/s2, which is {:.3g} g: is the unit right?",
                            motion.name, peak, peak / standard_gravity));
  if (motion.time_step > 0.1)
    add_warning(fmt::format("{}: its time step of {:g} s is long for a ground motion: is the unit right?", motion.name,
                            motion.time_step));
  // The largest velocity before the end is what a drift has to be compared with.
  if (!motion.velocity.empty()) {
    const double last = motion.velocity.back(), largest = motion.peak_velocity();
    if (std::abs(last) > 0.05 * largest && std::abs(last) > 1e-3)
      add_warning(
          fmt::format("{}: the baseline drifts: at its end ({:.4g} s) the base still moves with {:.3g} m/s (peak "
                      "{:.3g} m/s){}; correct the baseline of the record",
                      motion.name, end, last, largest,
                      duration > end ? fmt::format(", and goes on so until {:.4g} s", duration) : ""));
  }
  if (motion.time_step > 0.0 && step > motion.time_step * (1.0 + 1e-6))
    add_warning(
        fmt::format("the time step of {:g} s is longer than that of the record {} ({:g} s): values between the "
                    "steps are left out",
                    step, motion.name, motion.time_step));
}

void warn_about_late_start(const Motion& motion, double start) {
  const double end = motion.duration(), strong = motion.significant_duration(0.05, 0.99).second;
  if (start >= end)
    add_warning(fmt::format("the motion {} is over ({:.4g} s) when the run starts in it ({:.4g} s): nothing shakes",
                            motion.name, end, start));
  else if (start > strong)
    add_warning(fmt::format("99 % of the shaking of {} is over ({:.4g} s) when the run starts in it ({:.4g} s)",
                            motion.name, strong, start));
}

}  // namespace tailrun

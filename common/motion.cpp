#include "common/motion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/motion_units.hpp"

namespace tailrun {
namespace {

std::vector<double> integral(const std::vector<double>& rate, double dt) {
  std::vector<double> sum(rate.size(), 0.0);
  for (std::size_t i = 1; i < rate.size(); ++i) sum[i] = sum[i - 1] + 0.5 * dt * (rate[i - 1] + rate[i]);
  return sum;
}

}  // namespace

void Motion::integrate() {
  velocity = integral(acceleration, time_step);
}

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

Motion scaled_to_peak(Motion motion, double peak) {
  const double now = motion.peak_acceleration();
  if (now <= 0.0) throw InputError(fmt::format("{}: the motion is zero and cannot be scaled", motion.name));
  for (double& a : motion.acceleration) a *= peak / now;
  for (double& v : motion.velocity) v *= peak / now;
  return motion;
}

}  // namespace tailrun

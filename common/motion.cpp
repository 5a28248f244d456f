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

std::vector<double> squares_of(const std::vector<double>& values) {
  std::vector<double> squares(values.size());
  std::transform(values.begin(), values.end(), squares.begin(), [](double a) { return a * a; });
  return squares;
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
  const auto sum = integral(squares_of(acceleration), time_step);
  return sum.empty() ? 0.0 : std::numbers::pi / (2.0 * standard_gravity) * sum.back();
}

std::pair<double, double> Motion::significant_duration(double from, double to) const {
  const auto sum = integral(squares_of(acceleration), time_step);
  if (sum.empty() || sum.back() <= 0.0) return {0.0, 0.0};
  const auto arrival = [&](double share) {
    const auto it = std::lower_bound(sum.begin(), sum.end(), share * sum.back());
    return time_step * static_cast<double>(it - sum.begin());
  };
  return {arrival(from), arrival(to)};
}

double Motion::arias_share_after(double t) const {
  const auto sum = integral(squares_of(acceleration), time_step);
  if (sum.empty() || sum.back() <= 0.0) return 0.0;
  const double point = std::clamp(t / time_step, 0.0, static_cast<double>(sum.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(point), sum.size() - 1);
  const double next = sum[std::min(k + 1, sum.size() - 1)];
  return 1.0 - (sum[k] + (point - static_cast<double>(k)) * (next - sum[k])) / sum.back();
}

Motion scaled_to_peak(Motion motion, double peak) {
  const double now = motion.peak_acceleration();
  if (now <= 0.0) throw InputError(fmt::format("{}: the motion is zero and cannot be scaled", motion.name));
  for (double& a : motion.acceleration) a *= peak / now;
  for (double& v : motion.velocity) v *= peak / now;
  return motion;
}

}  // namespace tailrun

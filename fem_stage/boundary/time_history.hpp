// How a load changes with time: a dimensionless factor on its value.
#pragma once

#include <filesystem>
#include <vector>

namespace tailrun::fem {

class TimeHistory {
 public:
  // Constant 1.
  TimeHistory() = default;
  // 0 until `start` (s), linear to 1 at start + duration, 1 from there on; a duration of 0 is a step.
  static TimeHistory ramp(double start, double duration);
  // Ricker wavelet (1 - 2 a) exp(-a), a = (pi f (t - delay))^2; f in Hz, its peak of 1 at `delay` (s).
  static TimeHistory ricker(double frequency, double delay);
  // sin(2 pi f (t - start)) from `start` (s) on.
  static TimeHistory sine(double frequency, double start);
  // A CSV of time (s) and factor, times ascending: linear between rows, the first and last value outside. One header
  // line is allowed. Throws InputError.
  static TimeHistory table(const std::filesystem::path& path);

  double at(double time) const;
  bool constant() const { return kind_ == Kind::constant; }
  double largest() const;  // largest absolute factor that it can reach

 private:
  enum class Kind { constant, ramp, ricker, sine, table };
  TimeHistory(Kind kind, double start) : kind_(kind), start_(start) {}
  Kind kind_ = Kind::constant;
  double start_ = 0.0, duration_ = 0.0, frequency_ = 0.0;
  std::vector<double> time_, factor_;
};

}  // namespace tailrun::fem

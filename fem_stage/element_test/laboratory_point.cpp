#include "fem_stage/element_test/laboratory_point.hpp"

#include <array>
#include <cmath>

#include "common/error.hpp"

namespace tailrun::fem {

LaboratoryPoint::LaboratoryPoint(const MaterialDefinition& material, const LaboratoryStress& start, double out_of_plane)
    : point_({material}, {0}), committed_(start), trial_(start) {
  const std::array<double, 4> stress{-start.xx, -start.yy, -out_of_plane, start.xy};
  point_.set_stress(stress);
  point_.start_plastic_stage(true);
}

LaboratoryStress LaboratoryPoint::trial(const LaboratoryStrain& increment) {
  const std::array<double, 3> strain{-increment.xx, -increment.yy, increment.xy};
  std::array<double, 4> stress{};
  const UpdateReport report = point_.update(strain, stress);
  if (report.failed_point >= 0) throw ComputationError("element test: " + report.reason);
  ++updates_;
  substeps_ += report.substeps;
  increment_ = increment;
  trial_ = {-stress[0], -stress[1], stress[3]};
  return trial_;
}

void LaboratoryPoint::commit() {
  point_.commit();
  std::array<double, 4> stress{};
  point_.committed_stress(stress);
  committed_ = {-stress[0], -stress[1], stress[3]};
  strain_ = {strain_.xx + increment_.xx, strain_.yy + increment_.yy, strain_.xy + increment_.xy};
}

LaboratoryStrain LaboratoryPoint::solve(
    const std::function<LaboratoryStrain(double)>& increment_of,
    const std::function<double(const LaboratoryStress&, const LaboratoryStrain&)>& residual, double stiffness,
    double tolerance) {
  const auto evaluate = [&](double x) {
    const LaboratoryStrain increment = increment_of(x);
    return residual(trial(increment), increment);
  };
  // Secant steps kept inside the bracket once there is one (the residual grows with x).
  double x = last_free_;
  double r = evaluate(x);
  double low = 0.0, high = 0.0, r_low = 0.0, r_high = 0.0;
  bool has_low = false, has_high = false;
  double slope = stiffness;
  double best_x = x, best_r = r;
  for (int iteration = 0; iteration < 60 && std::fabs(r) > tolerance; ++iteration) {
    if (r < 0.0) {
      low = x, r_low = r, has_low = true;
    } else {
      high = x, r_high = r, has_high = true;
    }
    double next = x - r / slope;
    if (has_low && has_high) {
      const double width = high - low;
      const bool outside = (next - low) * (next - high) >= 0.0;
      if (outside) next = iteration % 3 == 2 ? 0.5 * (low + high) : low - r_low * width / (r_high - r_low);
      if (iteration > 10 && iteration % 3 == 2) next = 0.5 * (low + high);
      if (std::fabs(width) <= 1e-15) break;
    }
    const double r_next = evaluate(next);
    if (next != x && (r_next - r) / (next - x) > 1e-3 * stiffness) slope = (r_next - r) / (next - x);
    x = next;
    r = r_next;
    if (std::fabs(r) < std::fabs(best_r)) best_x = x, best_r = r;
  }
  if (std::fabs(r) > tolerance) {
    // The sub-stepping's own error leaves small jumps in the stress; a root lies inside one of them.
    r = evaluate(best_x);
    if (std::fabs(r) > 1e3 * tolerance) {
      throw ComputationError("element test: no strain keeps the stress condition (" + std::to_string(r) +
                             " Pa off at shear strain " + std::to_string(strain_.xy) + ")");
    }
    x = best_x;
  }
  last_free_ = x;
  return increment_;
}

double LaboratoryPoint::bulk() const {
  double K = 0.0, G = 0.0;
  point_.elastic_moduli({&K, 1}, {&G, 1});
  return K;
}

double LaboratoryPoint::shear() const {
  double K = 0.0, G = 0.0;
  point_.elastic_moduli({&K, 1}, {&G, 1});
  return G;
}

}  // namespace tailrun::fem

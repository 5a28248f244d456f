// The test programmes: what the apparatus controls step by step.
#include <chrono>
#include <cmath>

#include "fem_stage/element_test/element_test_case.hpp"

namespace tailrun::fem {

namespace {

// Stress path tolerance of the free strain, relative to the initial vertical effective stress.
constexpr double stress_tolerance = 1e-6;
// How close to its target amplitude a cyclic test turns, relative to the amplitude.
constexpr double turning_tolerance = 1e-3;

class Apparatus {
 public:
  explicit Apparatus(const ElementTestCase& test)
      : test_(test), sigma_v0_(test.vertical_effective_stress), point_(test.material, start(test), start(test).xx) {
    for (const double strain : test.report_strains) result_.shear_stress_at_strain.emplace_back(strain, std::nullopt);
    strain_resolution_ = test.stop_strain / 2000.0;
    stress_resolution_ =
        test.type == ElementTestType::cyclic_simple_shear ? 0.02 * test.csr * sigma_v0_ : 0.005 * sigma_v0_;
    record(true);
  }

  ElementTestResult run() {
    switch (test_.type) {
      case ElementTestType::cyclic_simple_shear:
        cyclic();
        break;
      case ElementTestType::monotonic_simple_shear:
        monotonic();
        break;
      case ElementTestType::plane_strain_compression:
        compression();
        break;
      case ElementTestType::strain_path:
        follow_path();
        break;
    }
    record(true);
    result_.cycles = cycle_;
    result_.steps = step_;
    result_.updates = point_.updates();
    result_.substeps = point_.substeps();
    return result_;
  }

 private:
  static LaboratoryStress start(const ElementTestCase& test) {
    const double vertical = test.vertical_effective_stress;
    return {test.K0 * vertical, vertical, test.static_shear_ratio * vertical};
  }

  // Trial of a shear strain increment with the drainage condition; xx is held.
  LaboratoryStress shear_trial(double increment) {
    if (test_.drainage == Drainage::constant_volume) return point_.trial({0.0, 0.0, increment});
    return solve([&](double e_yy) { return LaboratoryStrain{0.0, e_yy, increment}; }, &LaboratoryStress::yy);
  }
  // Trial of an axial (yy) strain increment; the lateral total stress is held.
  LaboratoryStress compression_trial(double increment) {
    if (test_.drainage == Drainage::constant_volume) return point_.trial({-increment, increment, 0.0});
    return solve([&](double e_xx) { return LaboratoryStrain{e_xx, increment, 0.0}; }, &LaboratoryStress::xx);
  }
  LaboratoryStress solve(const std::function<LaboratoryStrain(double)>& increment_of,
                         double LaboratoryStress::*component) {
    const double fluid = test_.drainage == Drainage::undrained ? test_.fluid_bulk_modulus / test_.porosity : 0.0;
    const double held = start(test_).*component;
    LaboratoryStress stress;
    const auto residual = [&](const LaboratoryStress& s, const LaboratoryStrain& increment) {
      stress = s;
      return s.*component + fluid * (point_.strain().volumetric() + increment.volumetric()) - held;
    };
    point_.solve(increment_of, residual, point_.bulk() + 4.0 / 3.0 * point_.shear() + fluid,
                 stress_tolerance * sigma_v0_);
    return stress;
  }

  void accept() {
    point_.commit();
    ++step_;
  }

  double shear_strain() const {
    return test_.type == ElementTestType::plane_strain_compression ? point_.strain().yy - point_.strain().xx
                                                                   : point_.strain().xy;
  }
  double shear_stress() const {
    return test_.type == ElementTestType::plane_strain_compression ? 0.5 * (point_.stress().yy - point_.stress().xx)
                                                                   : point_.stress().xy;
  }
  // Excess pore pressure over sigma'_v0: of the held total stress when undrained, of the missing effective vertical
  // stress at constant volume.
  double pore_pressure_ratio() const {
    if (test_.drainage == Drainage::undrained) {
      return test_.fluid_bulk_modulus / test_.porosity * point_.strain().volumetric() / sigma_v0_;
    }
    if (test_.drainage == Drainage::drained || test_.type == ElementTestType::strain_path) return 0.0;
    if (test_.type == ElementTestType::plane_strain_compression) {
      return (start(test_).xx - point_.stress().xx) / sigma_v0_;
    }
    return 1.0 - point_.stress().yy / sigma_v0_;
  }

  void record(bool always) {
    const double gamma = shear_strain();
    const double tau = shear_stress();
    const double ru = pore_pressure_ratio();
    const double moved = std::fabs(gamma);
    result_.largest_ru = std::max(result_.largest_ru, ru);
    const auto note = [&](std::optional<double>& when, bool reached) {
      if (reached && !when) when = cycle_;
    };
    if (test_.type == ElementTestType::cyclic_simple_shear) {
      note(result_.cycles_to_ru_95, ru >= 0.95);
      note(result_.cycles_to_ru_98, ru >= 0.98);
      note(result_.cycles_to_strain_1, moved >= 0.01);
      note(result_.cycles_to_strain_3, moved >= 0.03);
    }
    if (std::fabs(tau) > result_.peak_shear_stress) {
      result_.peak_shear_stress = std::fabs(tau);
      result_.peak_shear_strain = gamma;
    }
    for (auto& [strain, stress] : result_.shear_stress_at_strain) {
      if (stress || moved < strain) continue;
      // Between the step before and this one.
      const double share = moved > moved_before_ ? (strain - moved_before_) / (moved - moved_before_) : 1.0;
      stress = tau_before_ + std::clamp(share, 0.0, 1.0) * (tau - tau_before_);
    }
    moved_before_ = moved;
    tau_before_ = tau;

    bool wanted = always;
    if (test_.output_every > 0) {
      wanted = step_ % test_.output_every == 0;
    } else if (!always && !result_.rows.empty()) {
      const ElementTestRow& last = result_.rows.back();
      wanted = std::fabs(gamma - last.shear_strain) >= strain_resolution_ ||
               std::fabs(tau - last.shear_stress) >= stress_resolution_;
    }
    if (!wanted || (!result_.rows.empty() && result_.rows.back().step == step_)) return;
    result_.rows.push_back(
        {step_, cycle_, gamma, tau, point_.stress().yy, point_.stress().mean(), ru, point_.strain().volumetric()});
  }

  void cyclic() {
    const double amplitude = test_.csr * sigma_v0_;
    const double origin = test_.static_shear_ratio * sigma_v0_;
    double direction = 1.0;
    double cycle_at_turn = 0.0;
    double tau_at_turn = origin;
    double span = 0.25;  // cycles to the next turn
    while (std::fabs(shear_strain()) < test_.stop_strain && cycle_ < test_.stop_cycles) {
      const double target = origin + direction * amplitude;
      double increment = direction * test_.strain_increment;
      double beyond = direction * (shear_trial(increment).xy - target);
      // Shorten the last step so that the direction turns at the target.
      double low = 0.0, beyond_low = direction * (shear_stress() - target);
      double high = increment, beyond_high = beyond;
      for (int i = 0; i < 40 && beyond > turning_tolerance * amplitude; ++i) {
        const double share = std::clamp(-beyond_low / (beyond_high - beyond_low), 0.05, 0.95);
        increment = low + share * (high - low);
        beyond = direction * (shear_trial(increment).xy - target);
        if (beyond > 0.0) {
          high = increment, beyond_high = beyond;
        } else {
          low = increment, beyond_low = beyond;
        }
      }
      accept();
      const double travelled =
          direction * (shear_stress() - tau_at_turn) / std::max(direction * (target - tau_at_turn), 1e-9);
      cycle_ = std::max(cycle_, cycle_at_turn + span * std::clamp(travelled, 0.0, 1.0));
      const bool turn = direction * (shear_stress() - target) >= -turning_tolerance * amplitude;
      if (turn) cycle_ = cycle_at_turn + span;
      record(turn);
      if (!turn) continue;
      direction = -direction;
      cycle_at_turn = cycle_;
      tau_at_turn = shear_stress();
      span = 0.5;
    }
  }

  void monotonic() {
    while (std::fabs(shear_strain()) < test_.stop_strain * (1.0 - 1e-12)) {
      shear_trial(std::min(test_.strain_increment, test_.stop_strain - shear_strain()));
      accept();
      record(false);
    }
  }

  void compression() {
    while (point_.strain().yy < test_.stop_strain * (1.0 - 1e-12)) {
      compression_trial(std::min(test_.strain_increment, test_.stop_strain - point_.strain().yy));
      accept();
      record(false);
    }
  }

  void follow_path() {
    for (const StrainPathLeg& leg : test_.path) {
      for (long i = 0; i < leg.repeats; ++i) {
        point_.trial(leg.increment);
        accept();
        record(i + 1 == leg.repeats);
      }
    }
  }

  const ElementTestCase& test_;
  double sigma_v0_;
  LaboratoryPoint point_;
  ElementTestResult result_;
  double strain_resolution_ = 0.0;
  double stress_resolution_ = 0.0;
  double cycle_ = 0.0;
  long step_ = 0;
  double moved_before_ = 0.0;
  double tau_before_ = 0.0;
};

}  // namespace

ElementTestResult simulate(const ElementTestCase& test) {
  const auto start = std::chrono::steady_clock::now();
  ElementTestResult result = Apparatus(test).run();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace tailrun::fem

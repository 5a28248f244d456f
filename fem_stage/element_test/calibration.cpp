#include "fem_stage/element_test/calibration.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/application.hpp"
#include "common/case_file.hpp"
#include "common/error.hpp"
#include "fem_stage/element_test/curve_picture.hpp"
#include "fem_stage/element_test/element_test_case.hpp"

namespace tailrun::fem {

namespace {

struct CyclicTarget {
  double csr = 0.0;
  double cycles = 15.0;
  double shear_strain = 0.03;
  double vertical_effective_stress = 1e5;
  double K0 = 0.5;
  double static_shear_ratio = 0.0;
};

struct StrengthTarget {
  double vertical_effective_stress = 0.0;
  double shear_stress = 0.0;
};

struct Targets {
  std::optional<CyclicTarget> cyclic;
  double working_strain = 0.1;
  double residual_K0 = 0.5;
  std::vector<StrengthTarget> residual;
};

ElementTestCase cyclic_test(const Pm4SandParameters& sand, const CyclicTarget& target, double csr, double most_cycles) {
  ElementTestCase test;
  test.material = {"calibration", sand};
  test.vertical_effective_stress = target.vertical_effective_stress;
  test.K0 = target.K0;
  test.static_shear_ratio = target.static_shear_ratio;
  test.csr = csr;
  test.stop_cycles = most_cycles;
  test.stop_strain = target.shear_strain;
  return test;
}

// Cycles until the criterion strain; `most_cycles` when it is not reached by then.
double cycles_to_failure(const Pm4SandParameters& sand, const CyclicTarget& target, double csr, double most_cycles) {
  return simulate(cyclic_test(sand, target, csr, most_cycles)).cycles;
}

// Shear stress at the working strain in undrained monotonic simple shear.
double working_strength(const Pm4SandParameters& sand, const Targets& targets, double vertical_effective_stress) {
  ElementTestCase test;
  test.material = {"calibration", sand};
  test.vertical_effective_stress = vertical_effective_stress;
  test.K0 = targets.residual_K0;
  test.type = ElementTestType::monotonic_simple_shear;
  test.strain_increment = 1e-4;
  test.stop_strain = targets.working_strain;
  return simulate(test).rows.back().shear_stress;
}

double mean_log_strength_ratio(const Pm4SandParameters& sand, const Targets& targets) {
  double sum = 0.0;
  for (const StrengthTarget& t : targets.residual) {
    sum += std::log(working_strength(sand, targets, t.vertical_effective_stress) / t.shear_stress);
  }
  return sum / static_cast<double>(targets.residual.size());
}

// Root of a function that grows with x, by bisection between the ends of the admissible range, starting around `guess`.
double growing_root(const std::function<double(double)>& f, double guess, double step, double low, double high,
                    double accuracy, const std::string& what) {
  double a = guess, b = guess;
  double fa = f(guess), fb = fa;
  while (fa > 0.0 && a > low) fb = fa, b = a, a = std::max(low, a - step), fa = f(a), step *= 2.0;
  while (fb < 0.0 && b < high) fa = fb, a = b, b = std::min(high, b + step), fb = f(b), step *= 2.0;
  if (fa > 0.0 || fb < 0.0) {
    throw ComputationError(
        fmt::format("calibrate: no {} reaches the target; at the ends of its range the misfit is "
                    "{:.3g} and {:.3g}",
                    what, fa, fb));
  }
  while (b - a > accuracy) {
    const double middle = 0.5 * (a + b);
    (f(middle) < 0.0 ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

Targets read_targets(const CaseNode& root) {
  Targets targets;
  if (const auto node = root.object_if("cyclic_strength")) {
    CyclicTarget t;
    t.csr = node->number("csr", "1", Range::positive());
    t.cycles = node->number_or("cycles", "1", Range::between(0.5, 1000.0), t.cycles);
    t.shear_strain = node->number_or("shear_strain", "1", Range::open(0.0, 0.5), t.shear_strain);
    t.vertical_effective_stress =
        node->number_or("vertical_effective_stress", "Pa", Range::positive(), t.vertical_effective_stress);
    t.K0 = node->number_or("K0", "1", Range::positive(), t.K0);
    t.static_shear_ratio = node->number_or("static_shear_ratio", "1", Range::between(-1.0, 1.0), 0.0);
    targets.cyclic = t;
  }
  if (const auto node = root.object_if("residual_strength")) {
    targets.working_strain = node->number_or("shear_strain", "1", Range::open(0.0, 2.0), targets.working_strain);
    targets.residual_K0 = node->number_or("K0", "1", Range::positive(), targets.residual_K0);
    for (const CaseNode& row : node->list("targets")) {
      targets.residual.push_back({row.number("vertical_effective_stress", "Pa", Range::positive()),
                                  row.number("shear_stress", "Pa", Range::positive())});
    }
    if (targets.residual.empty()) node->fail("targets", "an empty list");
  }
  if (!targets.cyclic && targets.residual.empty()) {
    root.fail("", "neither cyclic_strength nor residual_strength is given; there is nothing to calibrate to");
  }
  return targets;
}

CurvePicture cyclic_curve(const Pm4SandParameters& sand, const CyclicTarget& target, std::string& csv) {
  CurvePicture chart{"Cyclic strength", "cycles to the strain criterion", "cyclic stress ratio", true, {}};
  Curve curve{"PM4Sand", {}, false};
  csv = "csr,cycles\n";
  const double most = 20.0 * target.cycles;
  for (const double factor : {0.75, 0.8, 0.85, 0.9, 0.95, 1.0, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0}) {
    const double csr = factor * target.csr;
    const double cycles = cycles_to_failure(sand, target, csr, most);
    if (cycles >= most) continue;  // does not fail within the range of interest
    curve.points.emplace_back(cycles, csr);
    csv += fmt::format("{:.6g},{:.6g}\n", csr, cycles);
  }
  chart.curves = {curve, {"target", {{target.cycles, target.csr}}, true}};
  return chart;
}

CurvePicture strength_curve(const Pm4SandParameters& sand, const Targets& targets, std::string& csv) {
  CurvePicture chart{fmt::format("Shear stress at {:g} % strain", 100.0 * targets.working_strain),
                     "vertical effective stress, kPa",
                     "shear stress, kPa",
                     false,
                     {}};
  double low = targets.residual.front().vertical_effective_stress, high = low;
  Curve target{"target", {}, true};
  for (const StrengthTarget& t : targets.residual) {
    low = std::min(low, t.vertical_effective_stress);
    high = std::max(high, t.vertical_effective_stress);
    target.points.emplace_back(1e-3 * t.vertical_effective_stress, 1e-3 * t.shear_stress);
  }
  Curve curve{"PM4Sand", {}, false};
  csv = "vertical_effective_stress,shear_stress\n";
  constexpr int count = 12;
  for (int i = 0; i <= count; ++i) {
    const double stress = high > low ? low + (high - low) * i / count : low * (0.5 + static_cast<double>(i) / count);
    const double strength = working_strength(sand, targets, stress);
    curve.points.emplace_back(1e-3 * stress, 1e-3 * strength);
    csv += fmt::format("{:.6g},{:.6g}\n", stress, strength);
  }
  chart.curves = {curve, target};
  return chart;
}

}  // namespace

int run_calibration(const CalibrationOptions& options) {
  const CaseFile file(options.case_file);
  const CaseNode root = file.root();
  const MaterialDefinition material = read_material(root.object("material"), "calibration");
  const auto* given = std::get_if<Pm4SandParameters>(&material.model);
  if (given == nullptr) root.fail("material/model", "only pm4sand can be calibrated");
  const Targets targets = read_targets(root);
  file.finish();

  Pm4SandParameters sand = *given;
  // Each of the two moves the other's target somewhat: one after the other until neither changes.
  const bool both = targets.cyclic && !targets.residual.empty();
  for (int round = 0; round < (both ? 20 : 1); ++round) {
    const Pm4SandParameters before = sand;
    if (!targets.residual.empty()) {
      sand.Q = growing_root(
          [&](double Q) {
            Pm4SandParameters trial = sand;
            trial.Q = Q;
            return mean_log_strength_ratio(trial, targets);
          },
          sand.Q, 0.5, 5.0, 20.0, 1e-3, "Q between 5 and 20");
    }
    if (targets.cyclic) {
      const double log_h = growing_root(
          [&](double log_h_po) {
            Pm4SandParameters trial = sand;
            trial.contraction_rate = std::exp(log_h_po);
            const double most = 4.0 * targets.cyclic->cycles;
            return std::log(cycles_to_failure(trial, *targets.cyclic, targets.cyclic->csr, most) /
                            targets.cyclic->cycles);
          },
          std::log(sand.contraction_rate), 0.5, std::log(1e-3), std::log(1e3), 2e-3, "h_po between 0.001 and 1000");
      sand.contraction_rate = std::exp(log_h);
    }
    if (std::fabs(sand.Q - before.Q) < 2e-3 &&
        std::fabs(std::log(sand.contraction_rate / before.contraction_rate)) < 5e-3) {
      break;
    }
  }

  nlohmann::ordered_json out;
  out["hpo"] = sand.contraction_rate;
  out["Q"] = sand.Q;
  out["R"] = sand.R;
  std::filesystem::create_directories(options.output_folder);
  const auto path = [&](const char* name) { return (options.output_folder / name).string(); };
  std::vector<CurvePicture> charts;
  std::string csv;
  if (targets.cyclic) {
    const double most = 20.0 * targets.cyclic->cycles;
    out["cyclic_strength"] = {{"csr", targets.cyclic->csr},
                              {"target_cycles", targets.cyclic->cycles},
                              {"cycles", cycles_to_failure(sand, *targets.cyclic, targets.cyclic->csr, most)}};
    charts.push_back(cyclic_curve(sand, *targets.cyclic, csv));
    write_text_file(path("cyclic_strength.csv"), csv);
  }
  if (!targets.residual.empty()) {
    out["residual_strength"] = nlohmann::ordered_json::array();
    for (const StrengthTarget& t : targets.residual) {
      out["residual_strength"].push_back(
          {{"vertical_effective_stress", t.vertical_effective_stress},
           {"target", t.shear_stress},
           {"shear_stress", working_strength(sand, targets, t.vertical_effective_stress)}});
    }
    charts.push_back(strength_curve(sand, targets, csv));
    write_text_file(path("residual_strength.csv"), csv);
  }
  write_text_file(path("calibration.svg"), svg_of(charts));
  write_text_file(path("calibration.json"), out.dump(2) + "\n");
  std::cout << out.dump(2) << "\n";
  return exit_done;
}

}  // namespace tailrun::fem

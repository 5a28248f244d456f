#include "fem_stage/element_test/calibration.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/application.hpp"
#include "common/case_file.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/output_place.hpp"
#include "common/warnings.hpp"
#include "fem_stage/element_test/calibration_targets.hpp"
#include "fem_stage/element_test/curve_picture.hpp"
#include "fem_stage/material/material_definition.hpp"

namespace tailrun::fem {

namespace {

using Json = nlohmann::ordered_json;

// Where a search ended: at the target, or at the end of the range that comes nearest to it.
struct Fit {
  double value = 0.0;
  bool reached = true;
};

// Root of a function that grows with x, by bisection between the ends of the admissible range, starting around `guess`.
Fit growing_root(const std::function<double(double)>& f, double guess, double step, double low, double high,
                 double accuracy) {
  double a = guess, b = guess;
  double fa = f(guess), fb = fa;
  while (fa > 0.0 && a > low) fb = fa, b = a, a = std::max(low, a - step), fa = f(a), step *= 2.0;
  while (fb < 0.0 && b < high) fa = fb, a = b, b = std::min(high, b + step), fb = f(b), step *= 2.0;
  if (fa > 0.0) return {a, false};
  if (!(fb >= 0.0)) return {b, false};
  while (b - a > accuracy) {
    const double middle = 0.5 * (a + b);
    (f(middle) < 0.0 ? a : b) = middle;
  }
  return {0.5 * (a + b), true};
}

constexpr double lowest_Q = 5.0, highest_Q = 20.0, lowest_hpo = 1e-3, highest_hpo = 1e3;
constexpr double usual_hpo = 10.0;  // published calibrations lie between 0.05 and about 6

// Q (R given) so that the residual strengths are met in the mean, with the other parameters as they are.
Fit fit_Q(const Pm4SandParameters& sand, const Targets& targets) {
  return growing_root(
      [&](double Q) {
        Pm4SandParameters trial = sand;
        trial.Q = Q;
        return mean_log_strength_ratio(trial, targets);
      },
      sand.Q, 0.5, lowest_Q, highest_Q, 1e-3);
}

// h_po so that the cyclic strength is met, with the other parameters as they are.
Fit fit_hpo(const Pm4SandParameters& sand, const CyclicTarget& target) {
  Fit fit = growing_root(
      [&](double log_h_po) {
        Pm4SandParameters trial = sand;
        trial.contraction_rate = std::exp(log_h_po);
        return std::log(cycles_to_failure(trial, target, target.csr, 4.0 * target.cycles) / target.cycles);
      },
      std::log(sand.contraction_rate), 0.5, std::log(lowest_hpo), std::log(highest_hpo), 2e-3);
  fit.value = std::exp(fit.value);
  return fit;
}

struct Calibrated {
  Pm4SandParameters sand;
  bool cyclic_reached = true, residual_reached = true;
};

// Each of the two moves the other's target somewhat: one after the other until neither changes.
Calibrated calibrated(const Pm4SandParameters& given, const Targets& targets) {
  Calibrated out{given};
  const bool both = targets.cyclic && !targets.residual.empty();
  for (int round = 0; round < (both ? 20 : 1); ++round) {
    const Pm4SandParameters before = out.sand;
    if (!targets.residual.empty()) {
      const Fit fit = fit_Q(out.sand, targets);
      out.sand.Q = fit.value;
      out.residual_reached = fit.reached;
    }
    if (targets.cyclic) {
      const Fit fit = fit_hpo(out.sand, *targets.cyclic);
      out.sand.contraction_rate = fit.value;
      out.cyclic_reached = fit.reached;
    }
    if (std::fabs(out.sand.Q - before.Q) < 2e-3 &&
        std::fabs(std::log(out.sand.contraction_rate / before.contraction_rate)) < 5e-3)
      break;
  }
  return out;
}

// When they cannot be met together: over the whole range of Q, with h_po for the cyclic strength at each, the one with
// the smallest misfit. `by_Q` gets a row for each.
Calibrated nearest_compromise(const Pm4SandParameters& given, const Targets& targets, Json& by_Q) {
  Calibrated best{given, false, false};
  double least = std::numeric_limits<double>::infinity();
  by_Q = Json::array();
  for (double Q = lowest_Q; Q <= highest_Q; Q += 1.0) {
    Pm4SandParameters trial = given;
    trial.Q = Q;
    const Fit hpo = fit_hpo(trial, *targets.cyclic);
    trial.contraction_rate = hpo.value;
    const double residual = mean_log_strength_ratio(trial, targets);
    const double cycles = cycles_to_failure(trial, *targets.cyclic, targets.cyclic->csr, 4.0 * targets.cyclic->cycles);
    by_Q.push_back({{"Q", Q}, {"hpo", hpo.value}, {"cycles", cycles}, {"residual_over_target", std::exp(residual)}});
    const double misfit =
        std::abs(residual) + (hpo.reached ? 0.0 : std::abs(std::log(cycles / targets.cyclic->cycles)));
    if (misfit < least) {
      least = misfit;
      best = {trial, hpo.reached, false};
    }
  }
  return best;
}

// What each target asks for by itself, the other parameter as the case gives it.
Json asked_for(const Pm4SandParameters& given, const Targets& targets, std::string& words) {
  Json out;
  if (targets.cyclic) {
    const Fit fit = fit_hpo(given, *targets.cyclic);
    out["cyclic_strength"] = {{"hpo", fit.value}, {"with_Q", given.Q}, {"reached", fit.reached}};
    words += fmt::format("the cyclic strength alone asks for hpo {}{:.3g} (with Q {:g}, as given)",
                         fit.reached ? "= " : "beyond ", fit.value, given.Q);
  }
  if (!targets.residual.empty()) {
    const Fit fit = fit_Q(given, targets);
    out["residual_strength"] = {{"Q", fit.value}, {"with_hpo", given.contraction_rate}, {"reached", fit.reached}};
    words += fmt::format("{}the residual strength alone asks for Q {}{:.4g} (with hpo {:g}, as given)",
                         words.empty() ? "" : ", ", fit.reached ? "= " : "beyond ", fit.value, given.contraction_rate);
    if (targets.cyclic) {  // and what the cyclic strength needs there
      Pm4SandParameters there = given;
      there.Q = fit.value;
      const Fit cyclic = fit_hpo(there, *targets.cyclic);
      out["cyclic_strength_at_that_Q"] = {{"hpo", cyclic.value}, {"reached", cyclic.reached}};
      words += fmt::format("; at that Q the cyclic strength asks for hpo {}{:.3g}", cyclic.reached ? "= " : "beyond ",
                           cyclic.value);
    }
  }
  return out;
}

// The case's material with the values found, to be pasted into fem.json's "materials".
Json materials_block(const CaseFile& file, const Pm4SandParameters& sand) {
  Json material = parse_json(file.path(), file.text()).at("material");
  material["hpo"] = sand.contraction_rate;
  material["Q"] = sand.Q;
  material["R"] = sand.R;
  return {{"calibrated", material}};
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

// How the strength of one relative density grows with the stress before is fixed by R and Q: targets that grow
// otherwise are met in the mean only.
void note_equal_strengths(const Json& out, const Targets& targets) {
  if (targets.residual.size() < 2) return;
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const auto& row : out.at("residual_strength")) {
    const double ratio = row.at("shear_stress").get<double>() / row.at("target").get<double>();
    low = std::min(low, ratio);
    high = std::max(high, ratio);
  }
  if (high > 1.1 * low)
    add_warning(fmt::format(
        "calibrate: the residual strengths are met in the mean only, at {:.0f} to {:.0f} % of their "
        "targets: R and Q fix how strength grows with the stress before, the targets ask for another growth",
        100.0 * low, 100.0 * high));
}

std::string what_was_reached(const Json& out, const std::string& alone, const std::string& file) {
  std::string text =
      fmt::format("calibrate: the targets cannot be met together: nearest are hpo {:.3g} and Q {:.4g}, with ",
                  out.at("hpo").get<double>(), out.at("Q").get<double>());
  bool first = true;
  if (out.contains("cyclic_strength")) {
    text += fmt::format("{:.3g} cycles for {:g}", out["cyclic_strength"]["cycles"].get<double>(),
                        out["cyclic_strength"]["target_cycles"].get<double>());
    first = false;
  }
  if (out.contains("residual_strength"))
    for (const auto& row : out["residual_strength"]) {
      text +=
          fmt::format("{}{:.3g} kPa for {:g} at {:g} kPa", first ? "" : ", ", 1e-3 * row["shear_stress"].get<double>(),
                      1e-3 * row["target"].get<double>(), 1e-3 * row["vertical_effective_stress"].get<double>());
      first = false;
    }
  return fmt::format("{}; {}. All of it is in {}", text, alone, file);
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
  require_results_apart(options.output_folder,
                        {"calibration.json", "cyclic_strength.csv", "residual_strength.csv", "calibration.svg"},
                        file.inputs());

  Calibrated result = calibrated(*given, targets);
  Json by_Q;
  if (targets.cyclic && !targets.residual.empty() && !(result.cyclic_reached && result.residual_reached))
    result = nearest_compromise(*given, targets, by_Q);
  const Pm4SandParameters& sand = result.sand;

  Json out;
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
    out["residual_strength"] = Json::array();
    for (const StrengthTarget& t : targets.residual) {
      out["residual_strength"].push_back(
          {{"vertical_effective_stress", t.vertical_effective_stress},
           {"target", t.shear_stress},
           {"shear_stress", working_strength(sand, targets, t.vertical_effective_stress)}});
    }
    charts.push_back(strength_curve(sand, targets, csv));
    write_text_file(path("residual_strength.csv"), csv);
  }
  std::string words;
  const bool reached = result.cyclic_reached && result.residual_reached;
  if (!reached) {
    out["reached"] = Json::object();
    if (targets.cyclic) out["reached"]["cyclic_strength"] = result.cyclic_reached;
    if (!targets.residual.empty()) out["reached"]["residual_strength"] = result.residual_reached;
    out["asked_for_alone"] = asked_for(*given, targets, words);
    if (!by_Q.is_null()) out["by_Q"] = by_Q;
  }
  if (sand.contraction_rate > usual_hpo)
    add_warning(
        fmt::format("calibrate: hpo = {:.3g} is far above what soils have (0.05 to about 6): the cyclic strength is "
                    "high for this relative density and Q",
                    sand.contraction_rate));
  note_equal_strengths(out, targets);
  out["materials"] = materials_block(file, sand);
  out["warnings"] = warnings();
  write_text_file(path("calibration.svg"), svg_of(charts));
  write_text_file(path("calibration.json"), text_of_json(out, 2) + "\n");
  if (!quiet() || reached) std::cout << text_of_json(out, 2) << "\n";
  if (!reached) throw ComputationError(what_was_reached(out, words, path("calibration.json")));
  return exit_done;
}

}  // namespace tailrun::fem

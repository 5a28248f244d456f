#include "fem_stage/element_test/element_test.hpp"

#include <fmt/core.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "common/application.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "fem_stage/element_test/element_test_case.hpp"

namespace tailrun::fem {

namespace {

nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json summary_of(const ElementTestCase& test, const ElementTestResult& result) {
  nlohmann::ordered_json out;
  out["material"] = model_name(test.material);
  out["cycles_to_ru_0.95"] = or_null(result.cycles_to_ru_95);
  out["cycles_to_ru_0.98"] = or_null(result.cycles_to_ru_98);
  out["cycles_to_shear_strain_0.01"] = or_null(result.cycles_to_strain_1);
  out["cycles_to_shear_strain_0.03"] = or_null(result.cycles_to_strain_3);
  out["cycles"] = result.cycles;
  out["largest_excess_pore_pressure_ratio"] = result.largest_ru;
  out["peak_shear_stress"] = result.peak_shear_stress;
  out["shear_strain_at_peak"] = result.peak_shear_strain;
  out["shear_stress_at_strain"] = nlohmann::ordered_json::array();
  for (const auto& [strain, stress] : result.shear_stress_at_strain) {
    out["shear_stress_at_strain"].push_back({{"shear_strain", strain}, {"shear_stress", or_null(stress)}});
  }
  const ElementTestRow& last = result.rows.back();
  out["final"] = {{"shear_strain", last.shear_strain},
                  {"shear_stress", last.shear_stress},
                  {"vertical_effective_stress", last.vertical_effective_stress},
                  {"mean_effective_stress", last.mean_effective_stress},
                  {"volumetric_strain", last.volumetric_strain}};
  out["steps"] = result.steps;
  out["updates"] = result.updates;
  out["substeps"] = result.substeps;
  out["seconds"] = result.seconds;
  return out;
}

std::string csv_of(const ElementTestResult& result) {
  std::string text =
      "step,cycle,shear_strain,shear_stress,vertical_effective_stress,mean_effective_stress,"
      "excess_pore_pressure_ratio,volumetric_strain\n";
  for (const ElementTestRow& row : result.rows) {
    text += fmt::format("{},{:.6g},{:.9g},{:.9g},{:.9g},{:.9g},{:.8g},{:.9g}\n", row.step, row.cycle, row.shear_strain,
                        row.shear_stress, row.vertical_effective_stress, row.mean_effective_stress,
                        row.excess_pore_pressure_ratio, row.volumetric_strain);
  }
  return text;
}

}  // namespace

int run_element_test(const ElementTestOptions& options) {
  const ElementTestCase test = read_element_test(options.case_file);
  const ElementTestResult result = simulate(test);
  const std::string summary = text_of_json(summary_of(test, result), 2) + "\n";
  if (!options.output.empty()) write_text_file(options.output.string(), csv_of(result));
  if (!options.summary.empty()) write_text_file(options.summary.string(), summary);
  if (!quiet() || options.summary.empty()) std::cout << summary;
  return exit_done;
}

}  // namespace tailrun::fem

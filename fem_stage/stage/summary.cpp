#include "fem_stage/stage/summary.hpp"

#include <omp.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "common/case_settings.hpp"
#include "common/provenance.hpp"
#include "common/warnings.hpp"

namespace tailrun::fem {

using Json = nlohmann::ordered_json;

Json mesh_summary(const Mesh& mesh) {
  const auto quality = scaled_jacobians(mesh, {});
  const auto worst = std::min_element(quality.begin(), quality.end());
  const auto centre = mesh.centre(static_cast<std::size_t>(worst - quality.begin()));
  Json regions;
  for (std::size_t r = 0; r < mesh.region_names.size(); ++r)
    regions[mesh.region_names[r]] = std::count(mesh.region.begin(), mesh.region.end(), static_cast<std::int32_t>(r));
  Json lines;
  for (const auto& [name, edges] : mesh.lines) lines[name] = edges.size();
  return {{"nodes", mesh.nodes()},         {"elements", mesh.elements()},
          {"elements_by_region", regions}, {"edges_by_line", lines},
          {"min_scaled_jacobian", *worst}, {"min_scaled_jacobian_at_m", {centre[0], centre[1]}},
          {"warnings", warnings()}};
}

Json geostatic_summary(const GeostaticReport& report) {
  return {{"elastic_residual_of_weight", report.elastic_residual},
          {"yielding_residual_of_weight", report.yielding_residual},
          {"yielding_iterations", report.yielding_iterations},
          {"switch_residual_of_weight", report.switch_residual},
          {"final_residual_of_weight", report.final_residual},
          {"settlement_m", report.settlement},
          {"largest_effective_tension_Pa", report.largest_tension},
          {"seconds", report.seconds},
          {"warnings", warnings()}};
}

Json consolidation_summary(const ConsolidationReport& report) {
  Json out;
  out["program"] = "fem_stage";
  out["version"] = version();
  if (!settings_in_use().empty()) out["settings"] = texts_of_settings();
  out["finished"] = report.failure.empty();
  if (!report.failure.empty()) out["failure"] = report.failure;
  out["start_time_s"] = report.start_time;
  out["end_time_s"] = report.end_time;
  out["largest_excess_pore_pressure_ratio"] = {{"start", report.first_ratio}, {"end", report.last_ratio}};
  out["largest_displacement_m"] = report.settlement;
  out["velocity_left_out_m_s"] = report.start_velocity;
  out["counts"] = {{"steps", report.counts.steps},
                   {"iterations", report.counts.iterations},
                   {"factorisations", report.counts.factorisations},
                   {"step_halvings", report.counts.halvings}};
  out["seconds"] = report.wall_seconds;
  out["snapshots"] = report.snapshots;
  out["warnings"] = warnings();
  return out;
}

Json shake_summary(const Model& model, const Motion& motion, const ShakeReport& report) {
  const auto optional = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  const SolverCounts& counts = report.counts;
  const EnergyLedger& ledger = report.ledger;
  Json out;
  out["program"] = "fem_stage";
  out["version"] = version();
  if (!settings_in_use().empty()) out["settings"] = texts_of_settings();
  out["finished"] = report.failure.empty();
  if (!report.failure.empty()) out["failure"] = report.failure;
  out["end_time_s"] = report.end_time;
  out["nodes"] = model.nodes();
  out["elements"] = model.count();
  out["threads"] = omp_get_max_threads();
  const auto strong = motion.significant_duration(0.05, 0.95);
  out["motion"] = {{"name", motion.name},
                   {"peak_acceleration_m_s2", motion.peak_acceleration()},
                   {"peak_velocity_m_s", motion.peak_velocity()},
                   {"arias_intensity_m_s", motion.arias_intensity()},
                   {"strong_shaking_s", {strong.first, strong.second}}};
  const double steps = static_cast<double>(std::max(counts.steps, 1L));
  out["counts"] = {{"steps", counts.steps},
                   {"iterations", counts.iterations},
                   {"iterations_per_step", static_cast<double>(counts.iterations) / steps},
                   {"factorisations", counts.factorisations},
                   {"factorisations_per_100_steps", 100.0 * static_cast<double>(counts.factorisations) / steps},
                   {"solves", counts.solves},
                   {"step_halvings", counts.halvings},
                   {"material_substeps", counts.material_substeps}};
  out["seconds"] = {{"total", report.wall_seconds},
                    {"elements_and_materials", counts.element_seconds},
                    {"materials", report.material_seconds},
                    {"assembly", counts.assembly_seconds},
                    {"factorisation", counts.factorisation_seconds},
                    {"solve", counts.solve_seconds},
                    {"output", report.output_seconds}};
  out["energy_J"] = {{"external_work", ledger.external_work},
                     {"kinetic", ledger.kinetic_energy},
                     {"skeleton_work", ledger.skeleton_work},
                     {"fluid_work", ledger.fluid_work},
                     {"hourglass", ledger.hourglass_work},
                     {"damping", ledger.damping_work},
                     {"dashpots", ledger.dashpot_work},
                     {"residual", ledger.residual()},
                     {"residual_of_largest", ledger.largest() > 0.0 ? ledger.residual() / ledger.largest() : 0.0},
                     {"open_since_s", optional(report.energy_open_since)},
                     {"hourglass_above_2_percent_since_s", optional(report.hourglass_since)}};
  if (!report.quality.empty()) {
    const QualityRow& last = report.quality.back();
    double jacobian = 1.0;
    for (const auto& row : report.quality) jacobian = std::min(jacobian, row.smallest_jacobian);
    out["largest_displacement_m"] = last.largest_displacement;
    out["min_scaled_jacobian"] = jacobian;
    out["inverted_elements"] = last.inverted;
    out["liquefied_depth_m"] = last.liquefied_depth;
    out["liquefied_share"] = last.liquefied_share;
    out["mean_excess_pore_pressure_ratio"] = last.mean_ratio;
  }
  if (!report.liquefaction.is_null()) out["residual_strength"] = report.liquefaction;
  out["transfer_window"] = {{"opens_s", optional(report.window.opens)},
                            {"closes_s", optional(report.window.closes)},
                            {"suggested_transfer_time_s", optional(report.window.suggested)},
                            {"shaking_left_then", report.window.shaking_left},
                            {"reason", report.window.reason},
                            {"snapshots_asked_for_s", model.options->output.snapshots}};
  out["snapshots"] = report.snapshots;
  out["warnings"] = warnings();
  Json skipped = Json::array();
  if (model.options->shake.damping_ratio == 0.0) skipped.push_back("rayleigh_damping");
  if (!model.options->shake.large_displacement) skipped.push_back("large_displacement");
  if (model.options->phreatic_line.empty()) skipped.push_back("pore_water");
  out["not_needed"] = skipped;
  return out;
}

}  // namespace tailrun::fem

#include "mpm_stage/output/summary.hpp"

#include <fmt/core.h>
#include <omp.h>
#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "common/case_settings.hpp"
#include "common/provenance.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/material/soil_limit.hpp"

namespace tailrun::mpm {

namespace {

using Json = nlohmann::ordered_json;

std::string shape_name(ShapeName shape) {
  switch (shape) {
    case ShapeName::linear:
      return "linear";
    case ShapeName::quadratic:
      return "quadratic B-spline";
    case ShapeName::cubic:
      return "cubic B-spline";
    case ShapeName::gimp:
      return "GIMP";
  }
  return "";
}

Json features(const Scene& scene) {
  Json chosen = Json::array(), skipped = Json::array();
  const auto say = [&](bool on, const std::string& what) { (on ? chosen : skipped).push_back(what); };
  const SolverOptions& o = scene.solver;
  chosen.push_back(fmt::format("{}-D kernels", scene.dimension));
  chosen.push_back(shape_name(o.shape) + " shape functions");
  chosen.push_back(o.transfer == TransferName::apic ? "APIC transfer"
                   : o.transfer == TransferName::aflip
                       ? fmt::format("AFLIP transfer, damping {}, of phi = 0 soil and fluids {}", o.transfer_damping,
                                     o.flow_transfer_damping)
                   : o.transfer == TransferName::flip ? fmt::format("FLIP/PIC transfer, FLIP share {}", o.flip_share)
                                                      : fmt::format("FMPM transfer, order {}", o.fmpm_order));
  bool pore = false, undrained = false, softening = false, rate = false, cutoff = false, average = false,
       limits = false;
  for (const auto& m : scene.materials) {
    if (m.law->rigid) continue;
    chosen.push_back(fmt::format("material '{}': {}", m.name, m.law->name));
    pore = pore || m.pore_pressure != PorePressure::total;
    undrained = undrained || m.pore_pressure == PorePressure::undrained;
    softening = softening || m.softening.active;
    rate = rate || m.rate.consistency > 0.0;
    cutoff = cutoff || m.tension_cutoff >= 0.0;
    limits = limits || (o.soil_limits_friction && soil_limit(constants_of(m, 1.0), 0.0) < no_soil_limit);
    average = average || (m.average_volumetric_strain && o.volumetric_average);
  }
  say(average, "averaged volumetric strain");
  say(pore, "pore pressure");
  say(undrained, "undrained pore pressure");
  say(softening, "softening");
  say(rate, "rate-dependent strength");
  say(cutoff, "tension cut-off");
  say(!scene.terrain.empty(), "terrain contact");
  say(!scene.terrain.empty() && limits, "friction limited by the soil's strength");
  say(o.fields.several(), fmt::format("velocity fields of their own ({})", o.fields.count));
  say(scene.walls.any_wall(), "walls of the grid");
  say(o.surface_share > 0.0, "velocities continued beyond the surface");
  say(!o.ponds.empty(), "ponded water");
  say(!scene.walls.bodies.empty(), "moving bodies");
  say(scene.base.shaken(), "base shaking");
  say(o.local_damping > 0.0, "local damping");
  say(o.sleep.speed > 0.0, "sleeping blocks");
  return {{"chosen", chosen}, {"skipped", skipped}};
}

// Strengths that were computed with, and what gave them.
Json strengths(const Scene& scene) {
  Json list = Json::array();
  for (const StrengthInUse& use : scene.strengths) {
    const StrengthTally& t = use.found;
    Json j = {{"material", use.material}, {"particles", t.count}, {"from", use.from}};
    j["law"] = use.law ? *use.law : Json();
    j["factor"] = use.factor;
    if (use.has_stress) j["initial_vertical_effective_stress_Pa"] = t.stress.json(t.count);
    j["strength_Pa"] = t.strength.json(t.count);
    if (use.from == "mpm.json") {
      j["capped_by_drained_strength"] = t.capped;
      j["raised_to_lower_bound"] = t.raised;
      j["outside_of_domain"] = t.outside;
    }
    if (use.steps.size() <= StrengthInUse::most_steps)
      for (const auto& [strength, step] : use.steps) {
        Json s = {{"strength_Pa", strength}, {"particles", step.first}};
        if (use.has_stress)
          s["mean_initial_vertical_effective_stress_Pa"] = step.second / static_cast<double>(step.first);
        j["steps"].push_back(s);
      }
    list.push_back(j);
  }
  return list;
}

// m, since the start of this run.
template <int Dim>
double largest_displacement(const Scene& scene, const Particles<Dim>& P) {
  double most = 0.0;
  for (std::size_t p = 0; p < P.count(); ++p) {
    double squares = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double u = P.position[d][p] - scene.particles.position[3 * static_cast<std::size_t>(P.identity[p]) + d];
      squares += u * u;
    }
    most = std::max(most, squares);
  }
  return std::sqrt(most);
}

// NaN is null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

// Where what flowed stands, measured from the toe, and how much height the dam has lost (runout_measures.hpp).
template <int Dim>
void tell_runout(const Scene& scene, const FrontSeries<Dim>& front, Json& j) {
  const FrontRow& last = front.rows().back();
  double largest = std::nan("");
  for (const auto& row : front.rows())
    if (!(front.runout(row) <= largest) && std::isfinite(row.flow_front)) largest = front.runout(row);
  j["front_direction"] = fmt::format("{}{}", scene.output.front_sign > 0.0 ? '+' : '-', "xyz"[scene.output.front_axis]);
  j["initial_toe_m"] = front.toe();
  j["flow_front_position_m"] = number(last.flow_front);
  j["runout_m"] = number(front.runout(last));
  j["runout_of_body_m"] = number(front.runout(last.flow_body));
  j["coherent_runout_m"] = number(front.runout(last.coherent_front));
  j["largest_runout_m"] = number(largest);
  j["runout_quantiles"] = {scene.output.front_quantile, scene.output.body_quantile};
  j["flow_distance_m"] = scene.output.flow_distance;
  j["footprint_m"] = front.footprint();
  j["ground_before_m"] = number(front.ground_before());
  j["ground_after_m"] = number(last.ground);
  j["freeboard_lost_m"] = number(front.ground_before() - last.ground);
}

}  // namespace

template <int Dim>
Json make_summary(const Scene& scene, Solver<Dim>& solver, const RunRecord& record, const Ledger<Dim>& ledger,
                  const FrontSeries<Dim>& front) {
  const PhaseSeconds& s = solver.seconds();
  const LedgerRow &first = ledger.rows().front(), &last = ledger.rows().back();
  const FrontRow& f1 = front.rows().back();
  const double compute = s.grid + s.grid_to_particles + s.volumetric + s.stress_and_scatter + s.sort;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  Json j;
  j["title"] = scene.title;
  j["version"] = version();
  if (!settings_in_use().empty()) j["settings"] = texts_of_settings();
  j["particles"] = solver.particles().count();
  j["particles_removed"] = solver.removed().size();
  j["removed_identities"] = solver.removed();
  j["particles_held_at_sides"] = solver.held().size();
  j["held_identities"] = solver.held();
  j["steps"] = record.steps;
  j["simulated_time_s"] = record.time;
  j["stop_reason"] = record.stop_reason;
  j["dt_min_s"] = record.dt_min;
  j["dt_mean_s"] = record.steps > 0 ? record.time / static_cast<double>(record.steps) : 0.0;
  j["dt_max_s"] = record.dt_max;
  j["front_position_m"] = f1.front;
  j["robust_front_position_m"] = f1.robust_front;
  tell_runout(scene, front, j);
  j["flowed_mass_kg"] = f1.flowed_mass;
  j["largest_displacement_m"] = largest_displacement(scene, solver.particles());
  j["top_m"] = f1.top;
  j["final_rms_speed_m_s"] = f1.rms_speed;
  j["final_maximum_speed_m_s"] = f1.maximum_speed;
  j["final_front_speed_m_s"] = number(front.front_speed(scene.rest.duration));
  j["unbalanced_force_ratio_first_step"] = record.first_unbalanced;
  j["largest_kinetic_energy_J"] = record.largest_kinetic;
  j["energy"] = {{"kinetic_J", last.kinetic},
                 {"elastic_J", last.elastic},
                 {"gravitational_change_J", last.gravitational - first.gravitational},
                 {"total_at_start_J", first.total()},
                 {"plastic_J", last.work.plastic},
                 {"friction_J", last.work.friction},
                 {"contact_J", last.work.contact},
                 {"damping_J", last.work.damping},
                 {"external_J", last.work.external},
                 {"pore_pressure_J", last.work.pore_pressure},
                 {"crowding_J", last.work.crowding},
                 {"removed_J", last.work.removed},
                 {"transfer_J", last.work.transfer},
                 {"impact_J", last.work.impact},
                 {"residual_J", last.residual},
                 {"turnover_J", ledger.turnover()},
                 {"lost_ratio", ledger.turnover() > 0.0 ? last.lost / ledger.turnover() : 0.0},
                 {"residual_ratio", ledger.turnover() > 0.0 ? last.residual / ledger.turnover() : 0.0}};
  j["mass_kg"] = last.mass;
  j["momentum_N_s"] = {last.momentum[0], last.momentum[1], last.momentum[2]};
  j["wall_seconds"] = {{"total", record.wall_seconds},
                       {"setup", record.setup_seconds},
                       {"grid", s.grid},
                       {"grid_to_particles", s.grid_to_particles},
                       {"volumetric_average", s.volumetric},
                       {"stress_and_particles_to_grid", s.stress_and_scatter},
                       {"sort", s.sort},
                       {"output_and_sampling", record.output_seconds}};
  j["threads"] = omp_get_max_threads();
  j["share_asleep"] = record.particle_steps > 0.0 ? record.asleep_particle_steps / record.particle_steps : 0.0;
  j["particle_steps_per_second"] = compute > 0.0 ? record.particle_steps / compute : 0.0;
  j["sorts"] = solver.sorts();
  j["occupied_blocks"] = solver.grid().occupied();
  j["grid_bytes_per_particle"] =
      static_cast<double>(solver.grid_bytes()) / static_cast<double>(solver.particles().count());
  j["peak_memory_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  for (std::size_t k = 0; k < scene.solver.ponds.size(); ++k) {
    const PondState& pond = solver.ponds()[k];
    Json said = {{"name", scene.solver.ponds[k].name}, {"level_m", pond.level}, {"runs_over", pond.escaped >= 0.0}};
    if (pond.escaped >= 0.0) {
      said["runs_over_since_s"] = pond.escaped;
      said["runs_over_at_m"] = std::vector<double>(pond.place.begin(), pond.place.begin() + scene.dimension);
    }
    j["ponds"].push_back(said);
  }
  if (!scene.strengths.empty()) j["residual_strength"] = strengths(scene);
  j["features"] = features(scene);
  j["remarks"] = scene.remarks;
  j["warnings"] = warnings();
  j["frames"] = record.frames;
  return j;
}

template Json make_summary<2>(const Scene&, Solver<2>&, const RunRecord&, const Ledger<2>&, const FrontSeries<2>&);
template Json make_summary<3>(const Scene&, Solver<3>&, const RunRecord&, const Ledger<3>&, const FrontSeries<3>&);

}  // namespace tailrun::mpm

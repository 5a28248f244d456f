// Points of PM4Sand or PM4Silt, each kind stored together (point_store.hpp says what the functions do). Compression is
// positive in the states and tension outside: signs turn here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fem_stage/material/pm4_point.hpp"
#include "fem_stage/material/point_store.hpp"

namespace tailrun::fem {

template <class ThisLaw>
class Pm4Points {
 public:
  using Law = ThisLaw;
  static constexpr std::size_t state_size =
      (sizeof(Pm4State) + sizeof(Pm4PointConstants) + sizeof(PointStage)) / sizeof(double);
  enum Variable {
    fabric,             // sqrt(z:z/2)
    fabric_cumulative,  // z_cum
    back_stress_ratio,  // sqrt(2 alpha:alpha), comparable with q/p
    stress_ratio,       // q/max(p, p_min)
    bounding_ratio,     // M_b
    state_parameter,    // xi_R (PM4Sand), xi/lambda (PM4Silt)
    last_substeps,      // of the last update that changed the point
    variable_count
  };
  static constexpr std::array<std::string_view, variable_count> variables{
      "fabric",         "fabric_cumulative", "back_stress_ratio", "stress_ratio",
      "bounding_ratio", "state_parameter",   "substeps"};

  void add(const Law* law) {
    law_.push_back(law);
    committed_.emplace_back();
    trial_.emplace_back();
    constants_.emplace_back();
    stage_.push_back({0.0, law->poisson, 0.0});
    yields_.push_back(0);
    last_strain_.emplace_back();
    substeps_.push_back(0);
  }
  void set_stress(std::size_t i, const PlaneStrainStress& s) {
    const Law& law = *law_[i];
    committed_[i] = Pm4State{};
    committed_[i].v.p = -0.5 * (s.xx + s.yy);
    committed_[i].v.s = {-0.5 * (s.xx - s.yy), -s.xy};
    constants_[i] = Pm4PointConstants{};
    stage_[i] = {0.0, law.poisson, s.zz - law.poisson * (s.xx + s.yy)};
    yields_[i] = 0;
    set_elastic_moduli(i);
  }
  void start_elastic_stage(std::size_t i, double poisson) {
    const PlaneStrainStress s = stress(i, committed_[i]);
    if (!std::isnan(poisson)) stage_[i].poisson = poisson;
    // The model's own stress and its constant offset are one from here on.
    const PlaneStress total = total_stress(constants_[i], committed_[i]);
    committed_[i].v.p = total.p;
    committed_[i].v.s = total.s;
    constants_[i].offset_p = 0.0;
    constants_[i].offset_s = {};
    stage_[i].plastic = 0.0;
    yields_[i] = 0;
    stage_[i].zz_origin = s.zz - stage_[i].poisson * (s.xx + s.yy);
    set_elastic_moduli(i);
  }
  void start_yielding_stage(std::size_t i) {
    if (law_[i]->compatibility == Pm4Compatibility::opensees) return;
    yields_[i] = 1;
    return_to_initial_strength(*law_[i], committed_[i].v);
    reset_trial(i);
  }
  void start_plastic_stage(std::size_t i, bool recompute) {
    const PlaneStrainStress s = stress(i, committed_[i]);
    const double sum = s.xx + s.yy;
    const PlaneStress total = total_stress(constants_[i], committed_[i]);
    initialise(*law_[i], total, recompute, constants_[i], committed_[i]);
    if (stage_[i].plastic == 0.0) {
      const bool compressed = sum < -2.0 * constants_[i].p_min;
      constants_[i].out_of_plane = std::clamp(compressed ? s.zz / sum : stage_[i].poisson, 0.0, 0.5);
    }
    stage_[i].plastic = 1.0;
    reset_trial(i);
  }
  void refresh_moduli(std::size_t i) {
    if (stage_[i].plastic == 0.0) return;
    const Pm4Variables& v = committed_[i].v;
    const Pm4Surfaces at = surfaces(i, std::max(v.p, constants_[i].p_min));
    committed_[i].set(at, moduli_of(*law_[i], constants_[i], at, v.p, v.s, v.z_cum));
    reset_trial(i);
  }

  void update(std::size_t first, std::span<const StrainIncrement> increment, std::span<long> substeps) {
    std::array<Pm4Update, update_block> updates;
    std::array<std::size_t, update_block> point_of;
    std::size_t count = 0;
    const auto integrate = [&] {
      if (count == 0) return;
      trial_updates(*law_[point_of[0]], options_, std::span(updates.data(), count));
      for (std::size_t k = 0; k < count; ++k) {
        substeps_[point_of[k]] = substeps[point_of[k] - first] = updates[k].substeps;
        if (updates[k].substeps < 0) reset_trial(point_of[k]);  // the same increment must fail again
      }
      count = 0;
    };
    for (std::size_t k = 0; k < increment.size(); ++k) {
      const std::size_t i = first + k;
      const StrainIncrement& e = increment[k];
      substeps[k] = 0;
      if (e == last_strain_[i]) continue;  // the trial state is already this increment's
      last_strain_[i] = e;
      if (e == StrainIncrement{}) {
        trial_[i] = committed_[i];
        continue;
      }
      if (!std::isfinite(e.xx + e.yy + e.xy)) {
        substeps[k] = -1;
        reset_trial(i);
        continue;
      }
      const PlaneStrain strain{-(e.xx + e.yy), {-0.5 * (e.xx - e.yy), -0.5 * e.xy}};
      if (stage_[i].plastic == 0.0) {
        elastic_stage_update(*law_[i], stage_[i].poisson, committed_[i], strain, trial_[i]);
        if (yields_[i]) return_to_initial_strength(*law_[i], trial_[i].v);
        substeps[k] = 1;
        continue;
      }
      if (count > 0 && law_[i] != law_[point_of[0]]) integrate();
      point_of[count] = i;
      updates[count++] = {&constants_[i], &committed_[i], strain, &trial_[i], 0};
    }
    integrate();
  }
  PlaneStrainStress trial_stress(std::size_t i) const { return stress(i, trial_[i]); }
  PlaneStrainStress committed_stress(std::size_t i) const { return stress(i, committed_[i]); }
  void commit(std::size_t i) {
    // An untouched point keeps its committed state: nothing to clip, nothing to recompute.
    if (last_strain_[i] == StrainIncrement{}) return;
    if (stage_[i].plastic == 0.0) {
      committed_[i] = trial_[i];
    } else {
      commit_update(*law_[i], constants_[i], committed_[i], trial_[i]);
    }
    reset_trial(i);
  }
  double bulk(std::size_t i) const { return committed_[i].K; }
  double shear(std::size_t i) const { return committed_[i].G; }
  double initial_shear(std::size_t i) const { return law_[i]->G0_pA; }
  double initial_bulk(std::size_t i) const {
    return bulk_over_shear_of(stage_[i].plastic == 0.0 ? stage_[i].poisson : law_[i]->poisson) * law_[i]->G0_pA;
  }

  void save(std::size_t i, double* out) const {
    append_bits(committed_[i], out);
    append_bits(constants_[i], out);
    append_bits(stage_[i], out);
  }
  void restore(std::size_t i, const double* in) {
    take_bits(in, committed_[i]);
    take_bits(in, constants_[i]);
    take_bits(in, stage_[i]);
    reset_trial(i);
  }

  double internal_variable(std::size_t i, std::size_t which) const {
    const Pm4Variables& v = committed_[i].v;
    const double p_star = std::max(v.p, constants_[i].p_min);
    switch (which) {
      case fabric:
        return sqrt_half * norm(v.z);
      case fabric_cumulative:
        return v.z_cum;
      case back_stress_ratio:
        return sqrt_two * norm(v.alpha);
      case stress_ratio:
        return p_star > 0.0 ? sqrt_two * norm(v.s) / p_star : 0.0;
      case bounding_ratio:
        return stage_[i].plastic != 0.0 ? surfaces(i, p_star).M_b : no_such_variable;
      case state_parameter:
        return stage_[i].plastic != 0.0 ? surfaces(i, p_star).xi : no_such_variable;
      default:
        return static_cast<double>(substeps_[i]);
    }
  }

 private:
  Pm4Surfaces surfaces(std::size_t i, double p_star) const {
    const Law& law = *law_[i];
    return law.surfaces(constants_[i], p_star, law.index0 + law.index_slope * committed_[i].volumetric_strain);
  }
  void reset_trial(std::size_t i) {
    trial_[i] = committed_[i];
    last_strain_[i] = {};
  }
  void set_elastic_moduli(std::size_t i) {
    committed_[i].G = law_[i]->G0_pA;
    committed_[i].K = bulk_over_shear_of(stage_[i].poisson) * law_[i]->G0_pA;
    reset_trial(i);
  }
  PlaneStrainStress stress(std::size_t i, const Pm4State& state) const {
    const PlaneStress t = total_stress(constants_[i], state);
    const double sum = -2.0 * t.p;
    const double zz =
        stage_[i].plastic == 0.0 ? stage_[i].zz_origin + stage_[i].poisson * sum : constants_[i].out_of_plane * sum;
    return {-(t.p + t.s.d), -(t.p - t.s.d), zz, -t.s.xy};
  }

  std::vector<const Law*> law_;
  std::vector<Pm4State> committed_;
  std::vector<Pm4State> trial_;
  std::vector<Pm4PointConstants> constants_;
  std::vector<PointStage> stage_;
  std::vector<char> yields_;  // in the elastic stage
  std::vector<StrainIncrement> last_strain_;
  std::vector<long> substeps_;
  Pm4AdaptiveOptions options_;
};

}  // namespace tailrun::fem

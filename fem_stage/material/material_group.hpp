// The points of one constitutive model, stored together: what MaterialPoints loops over without a virtual call. The two
// groups (Pm4Group for both PM4 laws, ElasticPlasticGroup for linear elasticity and Mohr-Coulomb) have the same member
// functions; indices are those of the group, stresses and strains tension positive.
#pragma once

#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "fem_stage/material/internal_variables.hpp"
#include "fem_stage/material/linear_elastic.hpp"
#include "fem_stage/material/mohr_coulomb.hpp"
#include "fem_stage/material/pm4_point.hpp"
#include "fem_stage/material/pm4sand.hpp"
#include "fem_stage/material/pm4silt.hpp"

namespace tailrun::fem {

struct StrainIncrement {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;  // engineering shear
  bool operator==(const StrainIncrement&) const = default;
};

// Points that are updated in one call at most: enough to keep the lanes of PM4 busy, few enough to share out the work.
constexpr std::size_t update_block = 32;

// What a point knows about its stage; saved with its state.
struct PointStage {
  double plastic = 0.0;    // 0: elastic stage, 1: the model itself
  double poisson = 0.3;    // of the elastic stage
  double zz_origin = 0.0;  // elastic stage of PM4: s_zz = zz_origin + poisson (s_xx + s_yy), tension positive, Pa
};

template <class T>
void append_bits(const T& value, double*& out) {
  std::memcpy(out, &value, sizeof(T));
  out += sizeof(T) / sizeof(double);
}
template <class T>
void take_bits(const double*& in, T& value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0);
  std::memcpy(static_cast<void*>(&value), in, sizeof(T));
  in += sizeof(T) / sizeof(double);
}

template <class Law>
class Pm4Group {
 public:
  static constexpr std::size_t state_size =
      (sizeof(Pm4State) + sizeof(Pm4PointConstants) + sizeof(PointStage)) / sizeof(double);

  void add(const Law* law) {
    law_.push_back(law);
    committed_.emplace_back();
    trial_.emplace_back();
    constants_.emplace_back();
    stage_.push_back({0.0, law->poisson, 0.0});
    last_strain_.emplace_back();
    substeps_.push_back(0);
  }
  std::size_t size() const { return law_.size(); }

  void set_stress(std::size_t i, const PlaneStrainStress& s) {
    const Law& law = *law_[i];
    committed_[i] = Pm4State{};
    committed_[i].v.p = -0.5 * (s.xx + s.yy);
    committed_[i].v.s = {-0.5 * (s.xx - s.yy), -s.xy};
    constants_[i] = Pm4PointConstants{};
    stage_[i] = {0.0, law.poisson, s.zz - law.poisson * (s.xx + s.yy)};
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
    stage_[i].zz_origin = s.zz - stage_[i].poisson * (s.xx + s.yy);
    set_elastic_moduli(i);
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
    const Law& law = *law_[i];
    const Pm4State& state = committed_[i];
    const double index = law.index0 + law.index_slope * state.volumetric_strain;
    const Pm4Surfaces surfaces = law.surfaces(constants_[i], std::max(state.v.p, constants_[i].p_min), index);
    const Pm4Moduli moduli = moduli_of(law, constants_[i], surfaces, state.v.p, state.v.s, state.v.z_cum);
    committed_[i].set(surfaces, moduli);
    reset_trial(i);
  }

  // Trial states of the points from `first` on, at most update_block of them. `substeps` of each: 0 when nothing was to
  // do, -1 when the increment could not be integrated.
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

  double internal_variable(std::size_t i, InternalVariable which) const;

 private:
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
  std::vector<StrainIncrement> last_strain_;
  std::vector<long> substeps_;
  Pm4AdaptiveOptions options_;
};

// Linear elasticity and Mohr-Coulomb: stress and plastic strain are all there is to remember.
struct ElasticPlasticLaw {
  double shear_modulus = 0.0;
  double poisson = 0.3;
  bool has_yield = false;
  MohrCoulombLaw mohr_coulomb;
};

struct ElasticPlasticState {
  PlaneStrainStress stress;
  double plastic_strain = 0.0;  // equivalent deviatoric
  double plastic_volume = 0.0;  // extension positive
};

class ElasticPlasticGroup {
 public:
  static constexpr std::size_t state_size = (sizeof(ElasticPlasticState) + sizeof(PointStage)) / sizeof(double);

  void add(const ElasticPlasticLaw* law) {
    law_.push_back(law);
    committed_.emplace_back();
    trial_.emplace_back();
    stage_.push_back({0.0, law->poisson, 0.0});
    last_strain_.emplace_back();
  }
  std::size_t size() const { return law_.size(); }
  void set_stress(std::size_t i, const PlaneStrainStress& s) {
    committed_[i] = {s, 0.0, 0.0};
    stage_[i] = {0.0, law_[i]->poisson, 0.0};
    reset_trial(i);
  }
  void start_elastic_stage(std::size_t i, double poisson) {
    if (!std::isnan(poisson)) stage_[i].poisson = poisson;
    stage_[i].plastic = 0.0;
    reset_trial(i);
  }
  void start_plastic_stage(std::size_t i, bool /*recompute*/) {
    stage_[i] = {1.0, law_[i]->poisson, 0.0};
    const ElasticPlasticLaw& law = *law_[i];
    // Elastic gravity may have left the yield surface; the excess becomes unbalanced force at once, not later.
    if (law.has_yield) {
      committed_[i].stress =
          return_to_yield(law.mohr_coulomb, law.shear_modulus, law.poisson, committed_[i].stress).stress;
    }
    committed_[i].plastic_strain = committed_[i].plastic_volume = 0.0;
    reset_trial(i);
  }
  void refresh_moduli(std::size_t) {}
  void update(std::size_t first, std::span<const StrainIncrement> increment, std::span<long> substeps) {
    for (std::size_t k = 0; k < increment.size(); ++k) substeps[k] = update(first + k, increment[k]);
  }
  long update(std::size_t i, const StrainIncrement& e) {
    if (e == last_strain_[i]) return 0;
    if (!std::isfinite(e.xx + e.yy + e.xy)) {
      reset_trial(i);
      return -1;
    }
    last_strain_[i] = e;
    const ElasticPlasticLaw& law = *law_[i];
    trial_[i] = committed_[i];
    trial_[i].stress = elastic_stress(committed_[i].stress, law.shear_modulus, stage_[i].poisson, e.xx, e.yy, e.xy);
    if (law.has_yield && stage_[i].plastic != 0.0) {
      const MohrCoulombReturn back =
          return_to_yield(law.mohr_coulomb, law.shear_modulus, law.poisson, trial_[i].stress);
      trial_[i].stress = back.stress;
      trial_[i].plastic_strain += back.plastic_strain;
      trial_[i].plastic_volume += back.plastic_volume;
    }
    return 1;
  }
  PlaneStrainStress trial_stress(std::size_t i) const { return trial_[i].stress; }
  PlaneStrainStress committed_stress(std::size_t i) const { return committed_[i].stress; }
  void commit(std::size_t i) {
    committed_[i] = trial_[i];
    reset_trial(i);
  }
  double bulk(std::size_t i) const { return bulk_modulus(law_[i]->shear_modulus, stage_[i].poisson); }
  double shear(std::size_t i) const { return law_[i]->shear_modulus; }
  double initial_shear(std::size_t i) const { return law_[i]->shear_modulus; }
  double initial_bulk(std::size_t i) const { return bulk(i); }
  void save(std::size_t i, double* out) const {
    append_bits(committed_[i], out);
    append_bits(stage_[i], out);
  }
  void restore(std::size_t i, const double* in) {
    take_bits(in, committed_[i]);
    take_bits(in, stage_[i]);
    reset_trial(i);
  }
  double internal_variable(std::size_t i, InternalVariable which) const;

 private:
  void reset_trial(std::size_t i) {
    trial_[i] = committed_[i];
    last_strain_[i] = {};
  }

  std::vector<const ElasticPlasticLaw*> law_;
  std::vector<ElasticPlasticState> committed_;
  std::vector<ElasticPlasticState> trial_;
  std::vector<PointStage> stage_;
  std::vector<StrainIncrement> last_strain_;
};

}  // namespace tailrun::fem

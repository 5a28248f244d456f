// Points of a model that is linear elastic up to a yield surface, or for ever: stress and plastic strain are all there
// is to remember. The law has a shear modulus (Pa), Poisson's ratio, `has_yield`, and, with a surface, to_yield().
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "fem_stage/material/point_store.hpp"

namespace tailrun::fem {

struct ElasticPlasticState {
  PlaneStrainStress stress;
  double plastic_strain = 0.0;  // equivalent deviatoric
  double plastic_volume = 0.0;  // extension positive
};

template <class ThisLaw>
class ElasticPlasticPoints {
 public:
  using Law = ThisLaw;
  static constexpr std::size_t state_size = (sizeof(ElasticPlasticState) + sizeof(PointStage)) / sizeof(double);
  static constexpr std::array<std::string_view, 2> variables{"plastic_strain", "plastic_volumetric_strain"};

  void add(const Law* law) {
    law_.push_back(law);
    committed_.emplace_back();
    trial_.emplace_back();
    stage_.push_back({0.0, law->poisson, 0.0});
    last_strain_.emplace_back();
  }
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
    // Elastic gravity may have left the yield surface; the excess becomes unbalanced force at once, not later.
    if constexpr (Law::has_yield) committed_[i].stress = law_[i]->to_yield(committed_[i].stress).stress;
    committed_[i].plastic_strain = committed_[i].plastic_volume = 0.0;
    reset_trial(i);
  }
  void start_yielding_stage(std::size_t i) { start_plastic_stage(i, false); }
  void refresh_moduli(std::size_t) {}
  void update(std::size_t first, std::span<const StrainIncrement> increment, std::span<long> substeps) {
    for (std::size_t k = 0; k < increment.size(); ++k) substeps[k] = update(first + k, increment[k]);
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
  double internal_variable(std::size_t i, std::size_t which) const {
    return which == 0 ? committed_[i].plastic_strain : committed_[i].plastic_volume;
  }

 private:
  long update(std::size_t i, const StrainIncrement& e) {
    if (e == last_strain_[i]) return 0;
    if (!std::isfinite(e.xx + e.yy + e.xy)) {
      reset_trial(i);
      return -1;
    }
    last_strain_[i] = e;
    const Law& law = *law_[i];
    trial_[i] = committed_[i];
    trial_[i].stress = elastic_stress(committed_[i].stress, law.shear_modulus, stage_[i].poisson, e.xx, e.yy, e.xy);
    if constexpr (Law::has_yield) {
      if (stage_[i].plastic != 0.0) {
        const auto back = law.to_yield(trial_[i].stress);
        trial_[i].stress = back.stress;
        trial_[i].plastic_strain += back.plastic_strain;
        trial_[i].plastic_volume += back.plastic_volume;
      }
    }
    return 1;
  }
  void reset_trial(std::size_t i) {
    trial_[i] = committed_[i];
    last_strain_[i] = {};
  }

  std::vector<const Law*> law_;
  std::vector<ElasticPlasticState> committed_;
  std::vector<ElasticPlasticState> trial_;
  std::vector<PointStage> stage_;
  std::vector<StrainIncrement> last_strain_;
};

}  // namespace tailrun::fem

// What every model's points share: the strain increment they are updated by, what they know about their stage, and how
// their numbers become rows of a state file. PointStore says what a model's store of points has to offer.
#pragma once

#include <concepts>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "fem_stage/material/isotropic_elasticity.hpp"

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

inline constexpr double no_such_variable = std::numeric_limits<double>::quiet_NaN();

// The points of one model, stored together. `i` is the index among these points; stresses and strains are tension
// positive, moduli in Pa. MaterialPoints chooses the store once and then loops over its points, so that these calls are
// inlined.
template <class S>
concept PointStore = requires(S store, const S& fixed, std::size_t i, const typename S::Law* law,
                              const PlaneStrainStress& stress, std::span<const StrainIncrement> increment,
                              std::span<long> substeps, double number, bool yes, double* out, const double* in) {
  // The law outlives the store; points of one material have the same.
  store.add(law);
  store.set_stress(i, stress);           // forgets what the point was; elastic stage
  store.start_elastic_stage(i, number);  // Poisson's ratio, NaN: the stage's own
  store.start_yielding_stage(i);         // still elastic, but with no more than the model carries at rest
  store.start_plastic_stage(i, yes);     // whether to work out again what follows from the stress at the start
  store.refresh_moduli(i);               // after the law's set_post_shaking
  store.update(i, increment, substeps);  // trial states of increment.size() <= update_block points from i on;
                                         // sub-steps of each: 0 nothing to do, -1 could not be integrated
  store.commit(i);                       // the trial state becomes the committed one
  { fixed.trial_stress(i) } -> std::same_as<PlaneStrainStress>;
  { fixed.committed_stress(i) } -> std::same_as<PlaneStrainStress>;
  { fixed.bulk(i) } -> std::same_as<double>;  // elastic moduli of the committed state
  { fixed.shear(i) } -> std::same_as<double>;
  { fixed.initial_bulk(i) } -> std::same_as<double>;
  { fixed.initial_shear(i) } -> std::same_as<double>;
  { S::state_size } -> std::convertible_to<std::size_t>;  // numbers of a point's row in the state file
  fixed.save(i, out);
  store.restore(i, in);
  // Named internal variables of the committed state, ratios or counts (unit 1), by their place in the list of names.
  { S::variables[i] } -> std::convertible_to<std::string_view>;
  { fixed.internal_variable(i, i) } -> std::same_as<double>;
};

}  // namespace tailrun::fem

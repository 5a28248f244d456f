// The list of models. A new one adds its name here and is otherwise in its own files, as linear_elastic.hpp is:
//
//   struct MyParameters {                                    what the case file says about a material
//     static constexpr std::string_view model_name = "...";  its word in "model"
//     using Points = ...;                                    store of its points (point_store.hpp)
//     double density;                                        kg/m3, of the saturated soil
//     static MyParameters read(const CaseNode&);             keys, units, ranges; throws InputError
//     double porosity() const;
//   };
//   MyLaw resolve(const MyParameters&);                      constants of a material; Points::Law
//
// A law has set_post_shaking(bool), which the points hear of by refresh_moduli. The row in docs/fem.md is checked by
// tests/verification/case/documented_keys_test.py.
#pragma once

#include <concepts>
#include <tuple>
#include <variant>

#include "fem_stage/material/linear_elastic.hpp"
#include "fem_stage/material/mohr_coulomb.hpp"
#include "fem_stage/material/pm4sand.hpp"
#include "fem_stage/material/pm4silt.hpp"

namespace tailrun::fem {

template <class P>
concept ModelParameters = requires(const P& given, const CaseNode& node, typename P::Points::Law& law) {
  { P::model_name } -> std::convertible_to<std::string_view>;
  { P::read(node) } -> std::same_as<P>;
  { given.density } -> std::convertible_to<double>;
  { given.porosity() } -> std::same_as<double>;
  { resolve(given) } -> std::same_as<typename P::Points::Law>;
  law.set_post_shaking(true);
  requires PointStore<typename P::Points>;
};

template <ModelParameters... Parameters>
struct ModelList {
  using AnyParameters = std::variant<Parameters...>;
  // One of a kind for each model: std::tuple<Of<Parameters>...>.
  template <template <class> class Of>
  using Each = std::tuple<Of<Parameters>...>;
};

using Models = ModelList<LinearElasticParameters,  //
                         MohrCoulombParameters,    //
                         Pm4SandParameters,        //
                         Pm4SiltParameters>;

}  // namespace tailrun::fem

// Which soil has liquefied or softens, and what it then has: the floor of its residual strength
// (material/residual_floor.hpp), softening by the element's height (material/softening_scale.hpp).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "fem_stage/material/residual_floor.hpp"
#include "fem_stage/material/softening_scale.hpp"
#include "fem_stage/model/model.hpp"

namespace tailrun::fem {

// The floor of a model's elements, s_R from the vertical effective stress before the earthquake, with what the state
// has of it already; nothing when no material of the case has a residual strength. Says the laws' warnings. Throws
// InputError when the state's stresses contain a floor that the case does not have.
std::optional<ResidualFloor> make_residual_floor(const Model& model, const State& state);

// Likewise; nothing when no material of the case has a reference height.
std::optional<SofteningScale> make_softening_scale(const Model& model, const State& state);

// Activates the floor of every element that has liquefied by now, and keeps in the state which have.
void observe_liquefaction(const Model& model, State& state, ResidualFloor& floor);

// Activates it in every element that has sheared beyond its material's strain, and keeps in the state which have.
void observe_softening(const Model& model, State& state, SofteningScale& scale);

// {material: the law with "elements", "liquefied_elements" and "liquefied_strength_Pa" of these}
nlohmann::ordered_json liquefaction_summary(const Model& model, const ResidualFloor& floor);

}  // namespace tailrun::fem

#include "fem_stage/stage/liquefaction.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.hpp"
#include "common/residual_strength/strength_law.hpp"
#include "common/residual_strength/strength_tally.hpp"
#include "common/warnings.hpp"
#include "fem_stage/output/state_file.hpp"

namespace tailrun::fem {
namespace {

// By region of the mesh: the index of its material.
std::vector<int> materials_of_regions(const Model& model) {
  std::vector<int> materials;
  for (const auto& name : model.mesh.region_names) materials.push_back(model.options->regions.at(name).material);
  return materials;
}

// m: the thickness of a band one element wide along the element's longer side, which is the lesser distance between the
// middles of opposite sides.
double height_of(const Mesh& mesh, std::size_t e) {
  const auto distance = [&](std::size_t a) {  // from the side a, a + 1 to the one across
    double across[2] = {0.0, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(mesh.quads[4 * e + (a + k) % 4]);
      across[0] += (k < 2 ? 0.5 : -0.5) * mesh.x(node);
      across[1] += (k < 2 ? 0.5 : -0.5) * mesh.y(node);
    }
    return std::hypot(across[0], across[1]);
  };
  return std::min(distance(0), distance(1));
}

}  // namespace

std::optional<ResidualFloor> make_residual_floor(const Model& model, const State& state) {
  const auto& chosen = model.options->residual_strength;
  if (chosen.empty()) {
    if (!state.floor_stress.empty())
      throw InputError(
          "the state's stresses contain the floor of a residual strength, but no material of the case has one; go on "
          "with the /materials/.../residual_strength that it was made with");
    return {};
  }
  std::vector<double> strength(model.count(), 0.0), mobilisation(model.count(), 1.0);
  std::map<int, StrengthTally> tallies;
  const std::vector<int> material = materials_of_regions(model);
  for (std::size_t e = 0; e < model.count(); ++e) {
    const auto found = chosen.find(material[static_cast<std::size_t>(model.mesh.region[e])]);
    if (found == chosen.end()) {
      if (!state.liquefied.empty() && state.liquefied[e] != 0.0)
        throw InputError(fmt::format(
            "the state's stresses contain the floor of a residual strength in region '{}', whose material has none; go "
            "on with the /materials/.../residual_strength that it was made with",
            model.mesh.region_names[static_cast<std::size_t>(model.mesh.region[e])]));
      continue;
    }
    const double sigma_v0 = std::max(0.0, -state.initial_stress[4 * e + 1]);
    const Strength s_R = (*found->second.law)(sigma_v0);
    strength[e] = s_R.value;
    mobilisation[e] = found->second.mobilisation_strain;
    tallies[found->first].add(sigma_v0, s_R);
  }
  for (const auto& [index, tally] : tallies)
    for (const auto& text : tally.warnings(*chosen.at(index).law))
      add_warning(fmt::format("/materials/{}/residual_strength: {}",
                              model.options->materials[static_cast<std::size_t>(index)].name, text));
  ResidualFloor floor(std::move(strength), mobilisation);
  if (!state.floor_stress.empty()) floor.restore(state.floor_stress, state.liquefied);
  return floor;
}

void observe_liquefaction(const Model& model, State& state, ResidualFloor& floor) {
  const auto strain = shear_strain(model, state);
  const std::vector<int> material = materials_of_regions(model);
  for (std::size_t e = 0; e < model.count(); ++e) {
    if (floor.strength(e) == 0.0 || floor.is_active(e)) continue;
    const LiquefiedStrength& given =
        model.options->residual_strength.at(material[static_cast<std::size_t>(model.mesh.region[e])]);
    if (state.max_pore_pressure_ratio[e] > given.pore_pressure_ratio || strain[e] > given.shear_strain)
      floor.activate(e);
  }
  state.liquefied.assign(floor.active().begin(), floor.active().end());
  state.floor_stress.assign(floor.stress().begin(), floor.stress().end());
}

std::optional<SofteningScale> make_softening_scale(const Model& model, const State& state) {
  const auto& chosen = model.options->softening;
  std::vector<double> scale(model.count(), 1.0);
  const std::vector<int> material = materials_of_regions(model);
  for (std::size_t e = 0; e < model.count(); ++e) {
    const auto found = chosen.find(material[static_cast<std::size_t>(model.mesh.region[e])]);
    if (found != chosen.end())
      scale[e] = height_of(model.mesh, e) / found->second.reference_height;
    else if (!state.softening.empty() && state.softening[e] != 0.0)
      throw InputError(fmt::format(
          "the state's soil softens by the height of its elements in region '{}', whose material has no reference "
          "height; go on with the /materials/.../softening that it was made with",
          model.mesh.region_names[static_cast<std::size_t>(model.mesh.region[e])]));
  }
  if (chosen.empty()) return {};
  SofteningScale out(std::move(scale));
  if (!state.softening.empty()) out.restore(state.softening);
  return out;
}

void observe_softening(const Model& model, State& state, SofteningScale& scale) {
  const auto strain = shear_strain(model, state);
  const std::vector<int> material = materials_of_regions(model);
  for (std::size_t e = 0; e < model.count(); ++e) {
    const auto found = model.options->softening.find(material[static_cast<std::size_t>(model.mesh.region[e])]);
    if (found != model.options->softening.end() && strain[e] > found->second.from_shear_strain) scale.activate(e);
  }
  state.softening.assign(scale.active().begin(), scale.active().end());
}

nlohmann::ordered_json liquefaction_summary(const Model& model, const ResidualFloor& floor) {
  nlohmann::ordered_json out;
  const std::vector<int> material = materials_of_regions(model);
  for (const auto& [index, given] : model.options->residual_strength) {
    long elements = 0, liquefied = 0;
    Spread strength;
    for (std::size_t e = 0; e < model.count(); ++e) {
      if (material[static_cast<std::size_t>(model.mesh.region[e])] != index) continue;
      ++elements;
      if (!floor.is_active(e)) continue;
      ++liquefied;
      strength.add(floor.strength(e));
    }
    auto row = given.law->record;
    row["mobilisation_strain"] = given.mobilisation_strain;
    row["elements"] = elements;
    row["liquefied_elements"] = liquefied;
    row["liquefied_strength_Pa"] = strength.json(liquefied);
    out[model.options->materials[static_cast<std::size_t>(index)].name] = row;
  }
  return out;
}

}  // namespace tailrun::fem

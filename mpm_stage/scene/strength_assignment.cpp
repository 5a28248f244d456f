// The strength of each particle: what the hand-over gave it or what "residual_strength" of mpm.json chooses again, and
// the cohesion of its material.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/residual_strength/strength_law.hpp"
#include "common/warnings.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

using Json = nlohmann::ordered_json;

double interpolated(const std::vector<double>& table, double x) {
  if (x <= table[0]) return table[1];
  for (std::size_t i = 2; i < table.size(); i += 2)
    if (x <= table[i])
      return table[i - 1] + (table[i + 1] - table[i - 1]) * (x - table[i - 2]) / (table[i] - table[i - 2]);
  return table.back();
}

const Material& material_of(const Scene& scene, std::size_t p) {
  return scene.materials[static_cast<std::size_t>(scene.particles.material_id[p])];
}

// Soil whose strength may be chosen again: that which has it from the hand-over, and no other strength.
bool takes_law(const Material& m) {
  return m.law->residual_strength && m.cohesion_from_particles;
}

int law_of(const ParticleSet& particles, std::size_t p) {
  return particles.strength_law.empty() ? -1 : particles.strength_law[p];
}

std::string particles_name(const Scene& scene) {
  return scene.inputs.empty() ? "/particles of the case" : scene.inputs.front().string();
}

KeptStrengthLaw kept_law(const Scene& scene, int index) {
  const ParticleSet& set = scene.particles;
  if (index < 0)
    return {{},
            fmt::format("{} has no law of the hand-over for these particles{}", particles_name(scene),
                        set.strength_law.empty() ? " (frames and files of earlier versions keep none)" : "")};
  const std::string place = fmt::format("{}: /tailrun/strength_laws, row {}", particles_name(scene), index);
  Json record = json_or_null(set.strength_laws[static_cast<std::size_t>(index)]);
  if (!record.is_object()) throw InputError(place + ": is not a JSON object, as transfer_tool writes it");
  return {std::move(record), place};
}

// The laws that "residual_strength" makes of those of the hand-over, by their number; empty when it chooses none.
std::map<int, StrengthLaw> chosen_laws(const CaseNode& node, const Scene& scene) {
  const auto &given = node.keys(), &known = strength_law_keys();
  const auto key = std::find_first_of(given.begin(), given.end(), known.begin(), known.end());
  std::map<int, StrengthLaw> laws;
  if (key == given.end()) {
    for (const auto& name : known) node.has(name);  // so that a misspelt one is answered with it
    return laws;
  }
  const ParticleSet& set = scene.particles;
  for (std::size_t p = 0; p < set.count(); ++p) {
    const int index = law_of(set, p);
    if (takes_law(material_of(scene, p)) && !laws.contains(index))
      laws.emplace(index, read_changed_strength_law(node, kept_law(scene, index)));
  }
  if (laws.empty())
    node.fail(*key,
              "there is no soil whose strength could be chosen: no material with particles is 'tresca' with cohesion "
              "'from_particles'");
  if (set.initial_vertical_effective_stress.empty())
    node.fail(*key, fmt::format("the strength follows from sigma'_v0, but {} has no dataset "
                                "/VTKHDF/PointData/initial_vertical_effective_stress; transfer_tool writes it",
                                particles_name(scene)));
  if (node.has("percentile")) {
    std::vector<std::string> without;
    for (const auto& [index, law] : laws)
      if (!has_percentile(law.model)) without.push_back(law.model);
    const std::string fact = fmt::format("the model '{}' has no percentile", joined(without));
    if (without.size() == laws.size())
      node.fail("percentile",
                fact + "; choose one that has by /residual_strength/model: weber, kramer_wang, olson_stark");
    if (!without.empty()) node.warn("percentile", fact + "; its strengths stay as they are");
  }
  return laws;
}

// Pa, by its material's law and the particle's strength.
double cohesion_of(const CaseFile& file, const Material& m, const ParticleSet& particles, std::size_t p) {
  const auto need = [&](const std::vector<double>& values, const std::string& field) {
    if (values.empty())
      throw InputError(fmt::format("{}: /materials/{}/cohesion asks for {}, which the particles do not have",
                                   file.path().string(), m.name, field));
  };
  if (m.cohesion_from_particles) {
    need(particles.residual_strength, "residual_strength");
    const double c = particles.residual_strength[p];
    if (!(c > 0.0))
      throw InputError(
          fmt::format("{}: /materials/{}/cohesion is 'from_particles', but particle {} has a residual strength of {} "
                      "Pa (must be > 0)",
                      file.path().string(), m.name, p, c));
    return c;
  }
  if (m.cohesion_table.empty() && !(m.cohesion_ratio > 0.0)) return m.cohesion;
  need(particles.initial_vertical_effective_stress, "initial_vertical_effective_stress");
  const double s = particles.initial_vertical_effective_stress[p];
  return std::max(m.minimum_cohesion,
                  m.cohesion_table.empty() ? m.cohesion_ratio * s : interpolated(m.cohesion_table, s));
}

}  // namespace

void assign_strength(const CaseFile& file, Scene& scene) {
  ParticleSet& set = scene.particles;
  const CaseNode node = file.root().object_or_empty("residual_strength");
  const auto laws = chosen_laws(node, scene);
  const bool any = std::any_of(set.material_id.begin(), set.material_id.end(), [&scene](std::int32_t id) {
    return scene.materials[static_cast<std::size_t>(id)].law->residual_strength;
  });
  if (set.residual_strength.empty() && (any && !laws.empty())) set.residual_strength.assign(set.count(), 0.0);

  std::map<std::pair<std::int32_t, int>, StrengthInUse> uses;
  const bool has_stress = !set.initial_vertical_effective_stress.empty();
  scene.cohesion.assign(set.count(), 0.0);
  for (std::size_t p = 0; p < set.count(); ++p) {
    const Material& m = material_of(scene, p);
    const double stress = has_stress ? set.initial_vertical_effective_stress[p] : 0.0;
    const int index = m.cohesion_from_particles ? law_of(set, p) : -1;
    const StrengthLaw* law = takes_law(m) && !laws.empty() ? &laws.at(index) : nullptr;
    Strength strength;
    if (law) {
      strength = (*law)(stress);
      set.residual_strength[p] = strength.value;
    }
    strength.value = scene.cohesion[p] = m.cohesion_factor * cohesion_of(file, m, set, p);
    if (!m.law->residual_strength) continue;

    StrengthInUse& use = uses[{set.material_id[p], index}];
    if (use.found.count == 0) {
      use.material = m.name;
      use.from = law ? "mpm.json" : m.cohesion_from_particles ? "hand-over" : "cohesion";
      if (law || index >= 0) use.law = std::make_shared<const Json>(law ? law->record : kept_law(scene, index).record);
      use.factor = m.cohesion_factor;
      use.has_stress = has_stress;
    }
    use.found.add(stress, strength);
    if (use.steps.size() <= StrengthInUse::most_steps) {
      auto& [count, sum] = use.steps[strength.value];
      ++count;
      sum += stress;
    }
  }
  // Frames show what was computed with, whatever it came from.
  if (any) set.residual_strength.resize(set.count(), 0.0);
  for (std::size_t p = 0; p < set.count(); ++p)
    if (material_of(scene, p).law->residual_strength) set.residual_strength[p] = scene.cohesion[p];
  for (auto& [key, use] : uses) {
    if (use.from == "mpm.json")
      for (const auto& warning : use.found.warnings(laws.at(key.second)))
        add_warning(
            fmt::format("residual strength of '{}' ({}): {}", use.material, laws.at(key.second).model, warning));
    scene.strengths.push_back(std::move(use));
  }
}

}  // namespace tailrun::mpm

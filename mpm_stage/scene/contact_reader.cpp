// "contact" of mpm.json: which soils have a velocity field of their own, and what holds them together.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mpm_stage/scene/key_checks.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

// phi = 0 soil and fluids against everything else; one field where all particles are of one kind.
std::vector<int> fields_by_strength(const Scene& scene) {
  std::vector<int> field;
  std::array<bool, 2> used{};
  for (const Material& m : scene.materials) field.push_back(m.law->flows ? 1 : 0);
  for (const std::int32_t id : scene.particles.material_id)
    used[static_cast<std::size_t>(field[static_cast<std::size_t>(id)])] = true;
  if (!used[0] || !used[1]) field.clear();
  return field;
}

std::vector<int> named_fields(const CaseNode& node, const Scene& scene, int& count) {
  const auto groups = node.list("groups");
  if (groups.size() < 2 || groups.size() > most_fields)
    node.fail("groups", fmt::format("has {} entries; there must be 2 to {}", groups.size(), most_fields));
  std::vector<int> field(scene.materials.size(), -1);
  std::vector<std::string> names;
  for (const Material& m : scene.materials) names.push_back(m.name);
  for (const CaseNode& group : groups) {
    const auto members = group.texts_or("materials", {});
    if (members.empty()) group.fail("materials", "needs the name of at least one material");
    for (const std::string& name : members) {
      const auto it = std::find(names.begin(), names.end(), name);
      if (it == names.end())
        group.fail("materials", fmt::format("names '{}', which is no material of a particle.{} There are: {}", name,
                                            did_you_mean(name, names), joined(names)));
      int& f = field[static_cast<std::size_t>(it - names.begin())];
      if (f == count) group.fail("materials", fmt::format("names '{}' twice", name));
      if (f >= 0)
        group.fail("materials", fmt::format("names '{}', which /contact/groups/{} has already; a material is in one "
                                            "group",
                                            name, f));
      f = count;
    }
    ++count;
  }
  for (const std::int32_t id : scene.particles.material_id)
    if (field[static_cast<std::size_t>(id)] < 0)
      node.fail("groups", fmt::format("leave out material '{}', which particles are made of",
                                      names[static_cast<std::size_t>(id)]));
  // Materials without particles may be left out.
  for (int& f : field) f = std::max(f, 0);
  return field;
}

}  // namespace

void read_contact(const CaseNode& root, Scene& scene) {
  const CaseNode node = root.object_or_empty("contact");
  FieldChoice& fields = scene.solver.fields;
  const std::string kind = node.choice_or("fields", {"strength", "one", "named"}, "strength");
  if (kind != "named") refuse_with_other_choice(node, "groups", "fields", kind, "'named'");
  if (kind != "strength") refuse_with_other_choice(node, "sides", "fields", kind, "'strength'");
  if (kind == "one")
    for (const char* key : {"friction", "opening"})
      refuse_with_other_choice(node, key, "fields", kind, "'strength' or 'named'");
  if (kind == "strength") {
    fields.of_material = fields_by_strength(scene);
    fields.by_side = node.boolean_or("sides", true) && !fields.of_material.empty();
    fields.count = fields.of_material.empty() ? 1 : (fields.by_side ? 3 : 2);
    const auto& g = scene.gravity;
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    if (length > 0.0)
      for (std::size_t d = 0; d < 3; ++d) fields.up[d] = -g[d] / length;
  } else if (kind == "named") {
    int count = 0;
    fields.of_material = named_fields(node, scene, count);
    fields.count = count;
  }
  if (kind == "one") return;
  fields.flows.assign(static_cast<std::size_t>(fields.count), 0);
  for (std::size_t m = 0; m < fields.of_material.size(); ++m)
    if (scene.materials[m].law->flows) fields.flows[static_cast<std::size_t>(fields.of_material[m])] = 1;
  if (const auto mu = node.number_if("friction", "1", Range::non_negative())) {
    scene.solver.contact.friction = *mu;
    check_friction(node, "friction", *mu, "the surfaces between fields");
    if (!fields.several())
      node.warn("friction", "does nothing: all particles are in one velocity field, and nothing slides in it");
  }
  scene.solver.contact.opening =
      node.choice_or("opening", {"free", "held"}, "free") == "free" ? Opening::free : Opening::held;
}

}  // namespace tailrun::mpm

// "ponded_water" of mpm.json: still water given here, or carried in the particles file. Without the key the file's
// ponds are taken as they are.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/log.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

namespace {

Pond pond_of(const PondedReach& reach, double gravity) {
  Pond pond;
  pond.name = reach.name;
  pond.time = {0.0};
  pond.level = {reach.level};
  if (!reach.endless[0]) pond.low[0] = reach.extent[0];
  if (!reach.endless[1]) pond.high[0] = reach.extent[1];
  pond.unit_weight = reach.density * gravity;
  return pond;
}

const PondedReach& reach_named(const CaseNode& node, const ParticleSet& particles) {
  const std::string wanted = node.text("from_particles");
  std::vector<std::string> names;
  for (const PondedReach& reach : particles.ponds) {
    if (reach.name == wanted) return reach;
    names.push_back(reach.name);
  }
  node.fail("from_particles", fmt::format("the particles file has no pond '{}' (it has: {}).{}", wanted,
                                          names.empty() ? "none" : joined(names), did_you_mean(wanted, names)));
}

// "level" or "level_history", which may be left out where the particles file says it.
void read_level(const CaseNode& node, Pond& pond) {
  if (node.has("level_history")) {
    pond.time.clear();
    pond.level.clear();
    const auto rows = node.table("level_history", "s, m", 2);
    for (std::size_t r = 0; r < rows.size(); r += 2) {
      if (!pond.time.empty() && !(rows[r] > pond.time.back()))
        node.fail("level_history", fmt::format("time {} s does not come after {} s", rows[r], pond.time.back()));
      pond.time.push_back(rows[r]);
      pond.level.push_back(rows[r + 1]);
    }
    if (pond.time.empty()) node.fail("level_history", "needs at least one row");
  } else if (pond.level.empty()) {
    pond.time = {0.0};
    pond.level = {node.number("level", "m", Range::any())};
  } else if (const auto level = node.number_if("level", "m", Range::any())) {
    pond.level = {*level};
  }
}

void read_range(const CaseNode& node, int dimension, Pond& pond) {
  constexpr std::array<std::array<const char*, 2>, 2> names = {{{"x_from", "x_to"}, {"z_from", "z_to"}}};
  for (int d = 0; d < dimension; d += 2) {
    const auto& [from, to] = names[static_cast<std::size_t>(d / 2)];
    const auto axis = static_cast<std::size_t>(d);
    if (const auto low = node.number_if(from, "m", Range::any())) pond.low[axis] = *low;
    if (const auto high = node.number_if(to, "m", Range::any())) pond.high[axis] = *high;
    if (!(pond.high[axis] > pond.low[axis]))
      node.fail(to, fmt::format("is {:g} m, but must be more than {}, {:g} m", pond.high[axis], from, pond.low[axis]));
  }
}

// At one place there is one level of water: two ponds would press twice.
void require_apart(const CaseNode& node, int dimension, const Pond& pond, const Pond& other) {
  constexpr double least = 1e-6;  // m
  for (int d = 0; d < dimension; d += 2) {
    const auto axis = static_cast<std::size_t>(d);
    if (!(std::min(pond.high[axis], other.high[axis]) - std::max(pond.low[axis], other.low[axis]) > least)) return;
  }
  node.fail("", fmt::format("pond '{}' (x from {:g} to {:g} m) covers ground that pond '{}' (x from {:g} to {:g} m) "
                            "covers, too, and both would press; set x_from and x_to apart",
                            pond.name, pond.low[0], pond.high[0], other.name, other.low[0], other.high[0]));
}

void require_upright(const CaseNode& root, const Scene& scene) {
  if (scene.gravity[0] == 0.0 && scene.gravity[2] == 0.0 && scene.gravity[1] < 0.0) return;
  root.fail("gravity", "ponded water needs gravity along -y, [0, -9.81]: its level is a height y");
}

}  // namespace

std::vector<Pond> read_ponds(const CaseNode& root, const Scene& scene) {
  const double gravity = -scene.gravity[1];
  const auto& carried = scene.particles.ponds;
  std::vector<Pond> ponds;
  if (!root.has("ponded_water")) {
    for (const PondedReach& reach : carried) ponds.push_back(pond_of(reach, gravity));
  } else {
    for (const CaseNode& node : root.list_or_empty("ponded_water")) {
      Pond pond;
      pond.unit_weight = 1000.0 * gravity;
      if (node.has("from_particles"))
        pond = pond_of(reach_named(node, scene.particles), gravity);
      else
        pond.name = node.text_or("name", fmt::format("pond_{}", ponds.size() + 1));
      read_level(node, pond);
      read_range(node, scene.dimension, pond);
      if (const auto density = node.number_if("density", "kg/m3", {500.0, 2000.0, false, false}))
        pond.unit_weight = *density * gravity;
      for (const Pond& other : ponds)
        if (other.name == pond.name)
          node.fail(node.has("from_particles") ? "from_particles" : "name",
                    fmt::format("'{}' is the name of two ponds", pond.name));
      for (const Pond& other : ponds) require_apart(node, scene.dimension, pond, other);
      ponds.push_back(std::move(pond));
    }
    for (const PondedReach& reach : carried)
      if (std::none_of(ponds.begin(), ponds.end(), [&](const Pond& pond) { return pond.name == reach.name; }))
        root.warn("ponded_water",
                  fmt::format("leaves out pond '{}' of the particles file, level {:g} m: the soil keeps "
                              "its pore pressures and has no water outside",
                              reach.name, reach.level));
  }
  if (!ponds.empty()) require_upright(root, scene);
  for (const Pond& pond : ponds)
    log_info("ponded water '{}': level {:g} m{}", pond.name, pond.level.front(),
             pond.level.size() > 1 ? " at the start, by its history" : "");
  return ponds;
}

std::vector<PondedReach> ponds_at(const Scene& scene, double time) {
  std::vector<PondedReach> reaches;
  for (const Pond& pond : scene.solver.ponds) {
    PondedReach reach{pond.name, pond.level_at(time), {}, {}, -pond.unit_weight / scene.gravity[1]};
    reach.endless = {!std::isfinite(pond.low[0]), !std::isfinite(pond.high[0])};
    // An end that is none still has a place in the file.
    reach.extent[0] = !reach.endless[0] ? pond.low[0] : reach.endless[1] ? 0.0 : pond.high[0] - 1.0;
    reach.extent[1] = !reach.endless[1] ? pond.high[0] : reach.extent[0] + 1.0;
    reaches.push_back(std::move(reach));
  }
  return reaches;
}

}  // namespace tailrun::mpm

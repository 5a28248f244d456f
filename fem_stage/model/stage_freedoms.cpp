#include "fem_stage/model/stage_freedoms.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

std::vector<std::int64_t> nodes_of_regions(const Mesh& mesh, const std::vector<std::string>& regions) {
  std::set<std::int64_t> nodes;
  for (const auto& name : regions) {
    const auto it = std::find(mesh.region_names.begin(), mesh.region_names.end(), name);
    if (it == mesh.region_names.end())
      throw InputError(fmt::format("/boundaries/tied_column_regions: the mesh has no region '{}'.{} It has: {}", name,
                                   did_you_mean(name, mesh.region_names), joined(mesh.region_names)));
    const auto id = static_cast<std::int32_t>(it - mesh.region_names.begin());
    for (std::size_t e = 0; e < mesh.elements(); ++e)
      if (mesh.region[e] == id)
        nodes.insert(mesh.quads.begin() + static_cast<long>(4 * e), mesh.quads.begin() + static_cast<long>(4 * e + 4));
  }
  return {nodes.begin(), nodes.end()};
}

// Splits nodes of the tied columns into connected columns (left and right of the dam must not be tied to each other).
std::vector<std::vector<std::int64_t>> separate_columns(const Mesh& mesh, const std::vector<std::int64_t>& nodes) {
  const std::set<std::int64_t> inside(nodes.begin(), nodes.end());
  std::vector<std::int64_t> parent(mesh.nodes());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int64_t n) {
    while (parent[static_cast<std::size_t>(n)] != n) n = parent[static_cast<std::size_t>(n)];
    return n;
  };
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const bool all =
        std::all_of(mesh.quads.begin() + static_cast<long>(4 * e), mesh.quads.begin() + static_cast<long>(4 * e + 4),
                    [&](auto n) { return inside.contains(n); });
    if (!all) continue;
    for (int a = 1; a < 4; ++a) {
      const auto p = root(mesh.quads[4 * e]), q = root(mesh.quads[4 * e + static_cast<std::size_t>(a)]);
      parent[static_cast<std::size_t>(std::max(p, q))] = std::min(p, q);
    }
  }
  std::map<std::int64_t, std::vector<std::int64_t>> columns;
  for (const auto node : nodes) columns[root(node)].push_back(node);
  std::vector<std::vector<std::int64_t>> out;
  for (auto& [unused, column] : columns) out.push_back(std::move(column));
  return out;
}

void fix_listed(const Model& model, When stage, Freedoms& freedoms) {
  for (const auto& item : model.options->boundaries.fixed) {
    if (item.when != When::both && item.when != stage) continue;
    for (const auto node : nodes_at(model.mesh, item.place)) {
      if (item.x) freedoms.fix(node, freedom_ux);
      if (item.y) freedoms.fix(node, freedom_uy);
      if (item.p) freedoms.fix(node, freedom_p);
    }
  }
}

Freedoms common_freedoms(const Model& model, When stage) {
  Freedoms freedoms(model.nodes());
  for (std::size_t n = 0; n < model.nodes(); ++n)
    if (model.pressure_fixed[n]) freedoms.fix(static_cast<std::int64_t>(n), freedom_p);
  const auto& boundaries = model.options->boundaries;
  for (const auto& line : boundaries.roller_lines)
    for (const auto node : nodes_at(model.mesh, {line, {}, "/boundaries/roller_lines"})) freedoms.fix(node, freedom_ux);
  if (stage == When::geostatic || boundaries.rock_p_velocity == 0.0)
    for (const auto node : model.base_nodes) freedoms.fix(node, freedom_uy);
  fix_listed(model, stage, freedoms);
  const double tolerance = 1e-3 * *std::min_element(model.elements.size.begin(), model.elements.size.end());
  constexpr Freedom displacement[] = {freedom_ux, freedom_uy};
  for (const auto& column : separate_columns(model.mesh, nodes_of_regions(model.mesh, boundaries.tied_column_regions)))
    tie_equal_heights(freedoms, model.mesh, column, tolerance, displacement, "/boundaries/tied_column_regions");
  std::set<std::int64_t> periodic;
  for (const auto& line : boundaries.periodic_lines) {
    const auto nodes = nodes_at(model.mesh, {line, {}, "/boundaries/periodic_lines"});
    periodic.insert(nodes.begin(), nodes.end());
  }
  constexpr Freedom all[] = {freedom_ux, freedom_uy, freedom_p};
  const std::vector<std::int64_t> tied(periodic.begin(), periodic.end());
  tie_equal_heights(freedoms, model.mesh, tied, tolerance, all, "/boundaries/periodic_lines");
  return freedoms;
}

bool any_fixed(const Model& model, const Freedoms& freedoms, Freedom freedom) {
  for (std::size_t n = 0; n < model.nodes(); ++n)
    if (freedoms.fixed(n, freedom)) return true;
  return false;
}

void require_held(bool held, const char* freedom, const char* stage) {
  if (!held)
    throw InputError(
        fmt::format("/boundaries: nothing holds the model's {} in the {} stage: give /boundaries/base, or fix it "
                    "somewhere with /boundaries/fixed{}",
                    freedom, stage, std::string(freedom) == "u_x" ? " or roller_lines" : ""));
}

}  // namespace

Freedoms geostatic_freedoms(const Model& model) {
  Freedoms freedoms = consolidation_freedoms(model);
  for (std::size_t n = 0; n < model.nodes(); ++n)
    if (model.dry_at_rest[n]) freedoms.fix(static_cast<std::int64_t>(n), freedom_p);
  return freedoms;
}

Freedoms consolidation_freedoms(const Model& model) {
  Freedoms freedoms = common_freedoms(model, When::geostatic);
  for (const auto node : model.base_nodes) freedoms.fix(node, freedom_ux);
  for (const auto& line : model.options->boundaries.geostatic_roller_lines)
    for (const auto node : nodes_at(model.mesh, {line, {}, "/boundaries/geostatic_roller_lines"}))
      freedoms.fix(node, freedom_ux);
  return freedoms;
}

Freedoms shaking_freedoms(const Model& model) {
  Freedoms freedoms = common_freedoms(model, When::shake);
  const auto& boundaries = model.options->boundaries;
  if (boundaries.base == BaseKind::rigid)
    for (const auto node : model.base_nodes) freedoms.fix(node, freedom_ux);
  else if (boundaries.base_tied)
    for (const auto node : model.base_nodes) freedoms.tie(model.base_nodes.front(), node, freedom_ux);
  return freedoms;
}

void check_support(const Model& model) {
  const auto& boundaries = model.options->boundaries;
  const Freedoms rest = geostatic_freedoms(model), shaking = shaking_freedoms(model);
  require_held(any_fixed(model, rest, freedom_ux), "u_x", "geostatic");
  require_held(any_fixed(model, rest, freedom_uy), "u_y", "geostatic");
  const bool dashpots = boundaries.base == BaseKind::lysmer_dashpot || !boundaries.free_field.empty();
  require_held(dashpots || any_fixed(model, shaking, freedom_ux), "u_x", "shake");
  require_held(dashpots || any_fixed(model, shaking, freedom_uy), "u_y", "shake");
  if (model.options->geostatic.seepage != Seepage::hydrostatic && !any_fixed(model, rest, freedom_p))
    throw InputError(
        "/boundaries: nothing holds the water pressure (every node lies under the phreatic line and no line is drained "
        "or ponded), so that seepage cannot find it: give a held pressure, or /geostatic/seepage 'hydrostatic'");
}

}  // namespace tailrun::fem

#include "fem_stage/stage/free_field.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/element_mean.hpp"
#include "common/error.hpp"

namespace tailrun::fem {
namespace {

double y_of(const Mesh& mesh, std::int64_t node) {
  return mesh.y(static_cast<std::size_t>(node));
}

std::int64_t node_at_height(const Mesh& mesh, const std::vector<std::int64_t>& nodes, double height, double tolerance,
                            const FreeFieldSide& side) {
  for (const auto node : nodes)
    if (std::abs(y_of(mesh, node) - height) <= tolerance) return node;
  throw InputError(
      fmt::format("{}: line '{}' has a node at elevation {:.6g} m, but column line '{}' has none there; the "
                  "two need the same elevations",
                  side.where, side.line, height, side.column_line));
}

std::size_t element_behind(const Mesh& mesh, std::int64_t a, std::int64_t b) {
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const auto *first = &mesh.quads[4 * e], *last = first + 4;
    if (std::find(first, last, a) != last && std::find(first, last, b) != last) return e;
  }
  return mesh.elements();
}

double mean_change_of_pressure(const Model& model, const State& state, std::size_t e) {
  const double now = element_mean(model.mesh.quads, state.pressure, e);
  const double at_rest = element_mean(model.mesh.quads, state.initial_pressure, e);
  return model.pressure_in_stress(e, now) - model.pressure_in_stress(e, at_rest);
}

}  // namespace

FreeField::FreeField(const Model& model, const MaterialPoints& points, const State& state) : model_(model) {
  if (model.options->boundaries.free_field.empty()) return;
  std::vector<double> bulk(model.count()), shear(model.count());
  points.elastic_moduli(bulk, shear);
  const Mesh& mesh = model.mesh;
  const double tolerance = 1e-3 * *std::min_element(model.elements.size.begin(), model.elements.size.end());
  for (const auto& side : model.options->boundaries.free_field) {
    const auto column_nodes = nodes_at(mesh, {side.column_line, {}, side.where});
    std::map<std::int64_t, Link> links;
    for (const auto& edge : boundary_edges(mesh, model.thickness, side.line, side.where)) {
      if (std::abs(edge.normal[0]) < 1.0 - 1e-6)
        throw InputError(fmt::format("{}: line '{}' is not vertical at y = {:.4g} m; a free field needs vertical sides",
                                     side.where, side.line, y_of(mesh, edge.a)));
      const auto ca = node_at_height(mesh, column_nodes, y_of(mesh, edge.a), tolerance, side),
                 cb = node_at_height(mesh, column_nodes, y_of(mesh, edge.b), tolerance, side);
      const std::size_t inside = element_behind(mesh, edge.a, edge.b), column = element_behind(mesh, ca, cb);
      if (column == mesh.elements())
        throw InputError(fmt::format("{}: no element of the column lies behind line '{}' from y = {:.4g} to {:.4g} m",
                                     side.where, side.column_line, y_of(mesh, ca), y_of(mesh, cb)));
      double water = 0.0;
      for (std::size_t a = 0; a < 4; ++a)
        water = std::max(water, state.pressure[static_cast<std::size_t>(mesh.quads[4 * inside + a])]);
      const double stiffness = bulk[inside] + 4.0 / 3.0 * shear[inside] +
                               (water > 0.0 && model.storage[inside] > 0.0 ? 1.0 / model.storage[inside] : 0.0);
      const double density = side.density > 0.0 ? side.density : model.density[inside];
      const double vs = side.shear_velocity > 0.0 ? side.shear_velocity : std::sqrt(shear[inside] / density);
      const double vp = side.p_velocity > 0.0 ? side.p_velocity : std::sqrt(stiffness / density);
      const double half = 0.5 * edge.length * edge.thickness;
      for (const auto& [node, column_node] : {std::pair{edge.a, ca}, std::pair{edge.b, cb}}) {
        Link& link = links.try_emplace(node, Link{node, column_node, 0.0, 0.0}).first->second;
        link.normal_impedance += density * vp * half;
        link.shear_impedance += density * vs * half;
      }
      faces_.push_back({edge.a, edge.b, column, half, edge.normal[0], 0.0, 0.0, 0.0, 0.0});
    }
    for (const auto& [node, link] : links) {
      links_.push_back(link);
      dashpots_.push_back({node, freedom_ux, link.normal_impedance});
      dashpots_.push_back({node, freedom_uy, link.shear_impedance});
    }
  }
  velocity_.resize(2 * links_.size());
  acceleration_.resize(2 * links_.size());
  time_ = state.time;
  observe(state);
}

void FreeField::observe(const State& state) {
  for (std::size_t k = 0; k < links_.size(); ++k)
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t freedom = 2 * static_cast<std::size_t>(links_[k].column_node) + i;
      velocity_[2 * k + i] = state.velocity[freedom];
      acceleration_[2 * k + i] = state.acceleration[freedom];
    }
  const double step = state.time - time_;
  for (Face& face : faces_) {
    const std::size_t e = face.column_element;
    const double xx = state.stress[4 * e] - state.initial_stress[4 * e] - mean_change_of_pressure(model_, state, e);
    const double xy = state.stress[4 * e + 3] - state.initial_stress[4 * e + 3];
    face.xx_rate = step > 0.0 ? (xx - face.xx) / step : 0.0;
    face.xy_rate = step > 0.0 ? (xy - face.xy) / step : 0.0;
    face.xx = xx;
    face.xy = xy;
  }
  time_ = state.time;
}

void FreeField::add_forces(double time, std::span<double> force) const {
  const double ahead = time - time_;
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const std::size_t i = 2 * static_cast<std::size_t>(links_[k].node);
    force[i] += links_[k].normal_impedance * (velocity_[2 * k] + ahead * acceleration_[2 * k]);
    force[i + 1] += links_[k].shear_impedance * (velocity_[2 * k + 1] + ahead * acceleration_[2 * k + 1]);
  }
  for (const Face& face : faces_) {
    const double along = face.half_area * face.outward;
    for (const auto node : {face.a, face.b}) {
      const std::size_t i = 2 * static_cast<std::size_t>(node);
      force[i] += along * (face.xx + ahead * face.xx_rate);
      force[i + 1] += along * (face.xy + ahead * face.xy_rate);
    }
  }
}

std::vector<double> FreeField::memory() const {
  std::vector<double> values = {time_};
  values.insert(values.end(), velocity_.begin(), velocity_.end());
  values.insert(values.end(), acceleration_.begin(), acceleration_.end());
  for (const Face& face : faces_) values.insert(values.end(), {face.xx, face.xy, face.xx_rate, face.xy_rate});
  return values;
}

void FreeField::restore(std::span<const double> memory) {
  if (memory.size() != this->memory().size())
    throw InputError("the checkpoint's free field is that of other sides (/boundaries/free_field)");
  const double* from = memory.data();
  time_ = *from++;
  for (auto* values : {&velocity_, &acceleration_})
    for (double& value : *values) value = *from++;
  for (Face& face : faces_)
    for (double* value : {&face.xx, &face.xy, &face.xx_rate, &face.xy_rate}) *value = *from++;
}

}  // namespace tailrun::fem

#include "fem_stage/model/own_weight.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/plausible_stiffness.hpp"
#include "common/warnings.hpp"

namespace tailrun::fem {
namespace {

constexpr double no_head = 2e-3;          // of water as deep as the model is high
constexpr double no_load = 100.0;         // Pa
constexpr double no_share_load = 1e-3;    // of the soil's weight
constexpr double too_much = 1e7;          // Pa
constexpr double too_many_times = 100.0;  // the weight of water, or soil

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();  // m
  double height() const { return std::max(0.0, high - low); }
};

// m, of the elements of one material; of all where it is negative.
Extent extent_of(const Model& model, int material) {
  const Mesh& mesh = model.mesh;
  Extent extent;
  for (std::size_t e = 0; e < mesh.elements(); ++e) {
    const auto& region = model.options->regions.at(mesh.region_names[static_cast<std::size_t>(mesh.region[e])]);
    if (material >= 0 && region.material != material) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      const double y = mesh.y(static_cast<std::size_t>(mesh.quads[4 * e + a]));
      extent.low = std::min(extent.low, y);
      extent.high = std::max(extent.high, y);
    }
  }
  return extent;
}

// "fem.json: /loads/0", for warnings.
std::string place_of(const Model& model, const std::string& where) {
  const auto& texts = model.options->provenance.texts;
  return (texts.empty() ? "" : texts.front().first + ": ") + where;
}

void check_held(const Model& model, double height) {
  const FemCase& options = *model.options;
  const double water = options.fluid_density * options.gravity * height;
  for (const auto& held : options.boundaries.held_pressure) {
    double most = 0.0;
    for (const auto node : model.mesh.nodes_of_line(held.line)) {
      const auto n = static_cast<std::size_t>(node);
      most =
          std::max(most, std::abs(held.field[0] + held.field[1] * model.mesh.x(n) + held.field[2] * model.mesh.y(n)));
    }
    if (most > 0.0 && most < no_head * water)
      add_warning(
          fmt::format("{}/pressure: at most {:.4g} Pa on line '{}' is next to nothing beside {:.4g} m of water, "
                      "as high as the model is ({:.3g} Pa); {:.4g} kPa are {:.4g} Pa",
                      place_of(model, held.where), most, held.line, height, water, most, 1e3 * most));
    if (most > too_much && most > too_many_times * water)
      add_warning(
          fmt::format("{}/pressure: up to {:.4g} Pa on line '{}' is that of {:.3g} m of water, in a model {:.4g} "
                      "m high; is it {:.4g} Pa?",
                      place_of(model, held.where), most, held.line, most / (options.fluid_density * options.gravity),
                      height, 1e-3 * most));
  }
}

void check_loads(const Model& model, double height) {
  const FemCase& options = *model.options;
  const double density = *std::max_element(model.density.begin(), model.density.end());
  const double weight = density * options.gravity * height;
  for (const LoadOptions& load : options.loads) {
    if (load.place.line.empty() || !load.history.constant()) continue;
    const double size = std::max(std::abs(load.pressure), std::hypot(load.traction[0], load.traction[1]));
    if (size > 0.0 && size < no_load && size < no_share_load * weight)
      add_warning(
          fmt::format("{}: {:.4g} Pa on line '{}' is next to nothing beside the weight of {:.4g} m of soil "
                      "({:.3g} Pa); {:.4g} kPa are {:.4g} Pa",
                      place_of(model, load.place.where), size, load.place.line, height, weight, size, 1e3 * size));
    if (size > too_much && size > too_many_times * weight)
      add_warning(
          fmt::format("{}: {:.4g} Pa on line '{}' is {:.3g} times the weight of {:.4g} m of soil; is it {:.4g} "
                      "Pa?",
                      place_of(model, load.place.where), size, load.place.line, size / weight, height, 1e-3 * size));
  }
}

}  // namespace

void check_own_weight(const CaseNode& root, const Model& model) {
  const auto entries = root.object("materials").members();
  for (std::size_t m = 0; m < entries.size(); ++m) {
    MaterialSetting setting;
    setting.gravity = model.options->gravity;
    setting.height = extent_of(model, static_cast<int>(m)).height();
    check_against_weight(entries[m].second, setting);
  }
}

void check_pressures(const Model& model) {
  const double height = extent_of(model, -1).height();
  if (model.options->gravity <= 0.0 || height <= 0.0) return;
  check_held(model, height);
  check_loads(model, height);
}

}  // namespace tailrun::fem

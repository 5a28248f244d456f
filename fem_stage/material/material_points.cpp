#include "fem_stage/material/material_points.hpp"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ranges>
#include <tuple>

#include "common/error.hpp"

namespace tailrun::fem {

namespace {

// The points of one model. Laws by material index; points hold pointers into them, so they are never resized after
// construction.
template <class Parameters>
struct Group {
  using Store = typename Parameters::Points;
  std::vector<typename Store::Law> laws;
  Store store;
  std::vector<std::size_t> points;  // global index of each
};

}  // namespace

struct MaterialPoints::Groups {
  std::vector<MaterialDefinition> materials;
  std::vector<int> material_of_point;
  Models::Each<Group> of_model;

  template <class Function>
  void for_each_group(Function&& function) {
    std::apply([&](auto&... group) { (function(group), ...); }, of_model);
  }
  // Calls function(store, index in it, global index) for every point, model by model.
  template <class Function>
  void for_each(Function&& function) {
    for_each_group([&](auto& group) {
      for (std::size_t i = 0; i < group.points.size(); ++i) function(group.store, i, group.points[i]);
    });
  }
};

namespace {

PlaneStrainStress row(std::span<const double> stress, std::size_t point) {
  const double* s = stress.data() + 4 * point;
  return {s[0], s[1], s[2], s[3]};
}

void store(const PlaneStrainStress& stress, std::span<double> out, std::size_t point) {
  double* s = out.data() + 4 * point;
  s[0] = stress.xx;
  s[1] = stress.yy;
  s[2] = stress.zz;
  s[3] = stress.xy;
}

void require_size(std::size_t found, std::size_t wanted, const char* what) {
  if (found != wanted) {
    throw InputError(std::string("material points: ") + what + " has " + std::to_string(found) + " numbers, " +
                     std::to_string(wanted) + " are needed");
  }
}

}  // namespace

MaterialPoints::MaterialPoints(std::vector<MaterialDefinition> materials, std::vector<int> material_of_point)
    : groups_(std::make_unique<Groups>()) {
  Groups& g = *groups_;
  const std::size_t count = materials.size();
  for (std::size_t point = 0; point < material_of_point.size(); ++point) {
    const int k = material_of_point[point];
    if (k < 0 || static_cast<std::size_t>(k) >= count) {
      throw InputError("material points: point " + std::to_string(point) + " has material index " + std::to_string(k) +
                       "; there are " + std::to_string(count) + " materials");
    }
  }
  g.for_each_group([&]<class Parameters>(Group<Parameters>& group) {
    group.laws.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      if (const auto* given = std::get_if<Parameters>(&materials[k].model)) group.laws[k] = resolve(*given);
    }
    for (std::size_t point = 0; point < material_of_point.size(); ++point) {
      const auto k = static_cast<std::size_t>(material_of_point[point]);
      if (!std::holds_alternative<Parameters>(materials[k].model)) continue;
      group.store.add(&group.laws[k]);
      group.points.push_back(point);
    }
  });
  g.materials = std::move(materials);
  g.material_of_point = std::move(material_of_point);
  set_stress(std::vector<double>(4 * size(), 0.0));
}

MaterialPoints::~MaterialPoints() = default;
MaterialPoints::MaterialPoints(MaterialPoints&&) noexcept = default;
MaterialPoints& MaterialPoints::operator=(MaterialPoints&&) noexcept = default;

std::size_t MaterialPoints::size() const {
  return groups_->material_of_point.size();
}
const std::vector<MaterialDefinition>& MaterialPoints::materials() const {
  return groups_->materials;
}
const std::vector<int>& MaterialPoints::material_of_point() const {
  return groups_->material_of_point;
}

void MaterialPoints::set_stress(std::span<const double> effective_stress) {
  require_size(effective_stress.size(), 4 * size(), "effective_stress");
  groups_->for_each(
      [&](auto& model, std::size_t i, std::size_t point) { model.set_stress(i, row(effective_stress, point)); });
}

void MaterialPoints::start_elastic_stage(std::span<const double> poisson_override) {
  if (!poisson_override.empty()) {
    require_size(poisson_override.size(), groups_->materials.size(), "poisson_override");
  }
  groups_->for_each([&](auto& model, std::size_t i, std::size_t point) {
    const double keep = std::numeric_limits<double>::quiet_NaN();
    model.start_elastic_stage(i, poisson_override.empty() ? keep : poisson_override[groups_->material_of_point[point]]);
  });
}

void MaterialPoints::start_yielding_stage() {
  groups_->for_each([](auto& model, std::size_t i, std::size_t) { model.start_yielding_stage(i); });
}

void MaterialPoints::start_plastic_stage(bool recompute_limits) {
  groups_->for_each([&](auto& model, std::size_t i, std::size_t) { model.start_plastic_stage(i, recompute_limits); });
}

void MaterialPoints::set_post_shaking(bool on) {
  groups_->for_each_group([on](auto& group) {
    for (auto& law : group.laws) law.set_post_shaking(on);
  });
  groups_->for_each([](auto& model, std::size_t i, std::size_t) { model.refresh_moduli(i); });
}

UpdateReport MaterialPoints::update(std::span<const double> strain_increment, std::span<double> effective_stress) {
  require_size(strain_increment.size(), 3 * size(), "strain_increment");
  require_size(effective_stress.size(), 4 * size(), "effective_stress");
  const auto start = std::chrono::steady_clock::now();
  long substeps = 0;
  int failed = std::numeric_limits<int>::max();
  // Liquefied points cost a hundred times a settled one, so work is handed out in small blocks; every point's result is
  // its own, so the order does not matter. One team for all models: a thread that finds no block of one model left goes
  // on to the next. Models of a single block each are not worth waking the other threads.
  bool worth_a_team = false;
  groups_->for_each_group([&](const auto& group) { worth_a_team |= group.points.size() > update_block; });
#pragma omp parallel if (worth_a_team) reduction(+ : substeps) reduction(min : failed)
  groups_->for_each_group([&](auto& group) {
    const std::vector<std::size_t>& points = group.points;
    const long blocks = static_cast<long>((points.size() + update_block - 1) / update_block);
#pragma omp for schedule(dynamic, 1) nowait
    for (long block = 0; block < blocks; ++block) {
      const std::size_t first = update_block * static_cast<std::size_t>(block);
      const std::size_t count = std::min(update_block, points.size() - first);
      std::array<StrainIncrement, update_block> strain;
      std::array<long, update_block> done;
      for (std::size_t k = 0; k < count; ++k) {
        const double* e = strain_increment.data() + 3 * points[first + k];
        strain[k] = {e[0], e[1], e[2]};
      }
      group.store.update(first, std::span(strain.data(), count), std::span(done.data(), count));
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t point = points[first + k];
        if (done[k] < 0) {
          failed = std::min(failed, static_cast<int>(point));
        } else {
          substeps += done[k];
        }
        store(group.store.trial_stress(first + k), effective_stress, point);
      }
    }
  });
  UpdateReport report;
  report.substeps = substeps;
  if (failed != std::numeric_limits<int>::max()) {
    report.failed_point = failed;
    const double* e = strain_increment.data() + 3 * static_cast<std::size_t>(failed);
    report.reason = fmt::format("material '{}' could not integrate the strain increment ({:.4g}, {:.4g}, {:.4g})",
                                groups_->materials[groups_->material_of_point[failed]].name, e[0], e[1], e[2]);
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

void MaterialPoints::commit() {
  groups_->for_each([](auto& model, std::size_t i, std::size_t) { model.commit(i); });
}

void MaterialPoints::committed_stress(std::span<double> effective_stress) const {
  require_size(effective_stress.size(), 4 * size(), "effective_stress");
  groups_->for_each([&](auto& model, std::size_t i, std::size_t point) {
    store(model.committed_stress(i), effective_stress, point);
  });
}

void MaterialPoints::elastic_moduli(std::span<double> bulk, std::span<double> shear) const {
  groups_->for_each([&](auto& model, std::size_t i, std::size_t point) {
    bulk[point] = model.bulk(i);
    shear[point] = model.shear(i);
  });
}

void MaterialPoints::initial_moduli(std::span<double> bulk, std::span<double> shear) const {
  groups_->for_each([&](auto& model, std::size_t i, std::size_t point) {
    bulk[point] = model.initial_bulk(i);
    shear[point] = model.initial_shear(i);
  });
}

void MaterialPoints::density(std::span<double> out) const {
  for (std::size_t i = 0; i < size(); ++i) out[i] = density_of(groups_->materials[groups_->material_of_point[i]]);
}

void MaterialPoints::porosity(std::span<double> out) const {
  for (std::size_t i = 0; i < size(); ++i) out[i] = porosity_of(groups_->materials[groups_->material_of_point[i]]);
}

std::size_t MaterialPoints::state_size() const {
  std::size_t largest = 0;
  groups_->for_each_group(
      [&]<class Parameters>(const Group<Parameters>&) { largest = std::max(largest, Parameters::Points::state_size); });
  return largest;
}

std::vector<double> MaterialPoints::save_state() const {
  std::vector<double> state(size() * state_size(), 0.0);
  groups_->for_each(
      [&](auto& model, std::size_t i, std::size_t point) { model.save(i, state.data() + point * state_size()); });
  return state;
}

const std::vector<std::string>& MaterialPoints::internal_variable_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    const auto add = [&](std::string_view name) {
      if (std::find(all.begin(), all.end(), name) == all.end()) all.emplace_back(name);
    };
    std::apply([&]<class... P>(const Group<P>&...) { (std::ranges::for_each(P::Points::variables, add), ...); },
               Models::Each<Group>{});
    return all;
  }();
  return names;
}

void MaterialPoints::internal_variable(std::string_view name, std::span<double> out) const {
  const std::vector<std::string>& names = internal_variable_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw InputError("no internal variable is called '" + std::string(name) + "'." + did_you_mean(name, names) +
                     " Known: " + joined(names));
  }
  require_size(out.size(), size(), "internal_variable's result");
  groups_->for_each_group([&]<class Parameters>(const Group<Parameters>& group) {
    const auto& known = Parameters::Points::variables;
    const auto which = static_cast<std::size_t>(std::find(known.begin(), known.end(), name) - known.begin());
    for (std::size_t i = 0; i < group.points.size(); ++i) {
      out[group.points[i]] = which < known.size() ? group.store.internal_variable(i, which) : no_such_variable;
    }
  });
}

void MaterialPoints::restore_state(std::span<const double> state) {
  require_size(state.size(), size() * state_size(), "saved state");
  groups_->for_each(
      [&](auto& model, std::size_t i, std::size_t point) { model.restore(i, state.data() + point * state_size()); });
}

}  // namespace tailrun::fem

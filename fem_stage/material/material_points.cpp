#include "fem_stage/material/material_points.hpp"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "common/error.hpp"
#include "fem_stage/material/material_group.hpp"

namespace tailrun::fem {

struct MaterialPoints::Groups {
  std::vector<MaterialDefinition> materials;
  std::vector<int> material_of_point;
  // Laws by material index; a group's points hold pointers into these, so they are never resized after construction.
  std::vector<Pm4SandLaw> sand_laws;
  std::vector<Pm4SiltLaw> silt_laws;
  std::vector<ElasticPlasticLaw> elastic_laws;
  Pm4Group<Pm4SandLaw> sand;
  Pm4Group<Pm4SiltLaw> silt;
  ElasticPlasticGroup elastic;
  std::vector<std::size_t> sand_points, silt_points, elastic_points;  // global index of a group's points

  template <class Function>
  void for_each_group(Function&& function) {
    function(sand, sand_points);
    function(silt, silt_points);
    function(elastic, elastic_points);
  }
  // Calls function(group, index in group, global index) for every point, in order.
  template <class Function>
  void for_each(Function&& function) {
    for_each_group([&](auto& group, const std::vector<std::size_t>& points) {
      for (std::size_t i = 0; i < points.size(); ++i) function(group, i, points[i]);
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

ElasticPlasticLaw elastic_plastic_law(const MaterialDefinition& material) {
  if (const auto* p = std::get_if<MohrCoulombParameters>(&material.model)) {
    return {p->shear_modulus, p->poisson, true, resolve(*p)};
  }
  const auto& p = std::get<LinearElasticParameters>(material.model);
  return {p.shear_modulus, p.poisson, false, {}};
}

}  // namespace

MaterialPoints::MaterialPoints(std::vector<MaterialDefinition> materials, std::vector<int> material_of_point)
    : groups_(std::make_unique<Groups>()) {
  Groups& g = *groups_;
  const std::size_t count = materials.size();
  g.sand_laws.resize(count);
  g.silt_laws.resize(count);
  g.elastic_laws.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (const auto* sand = std::get_if<Pm4SandParameters>(&materials[k].model)) {
      g.sand_laws[k] = resolve(*sand);
    } else if (const auto* silt = std::get_if<Pm4SiltParameters>(&materials[k].model)) {
      g.silt_laws[k] = resolve(*silt);
    } else {
      g.elastic_laws[k] = elastic_plastic_law(materials[k]);
    }
  }
  for (std::size_t point = 0; point < material_of_point.size(); ++point) {
    const int k = material_of_point[point];
    if (k < 0 || static_cast<std::size_t>(k) >= count) {
      throw InputError("material points: point " + std::to_string(point) + " has material index " + std::to_string(k) +
                       "; there are " + std::to_string(count) + " materials");
    }
    if (std::holds_alternative<Pm4SandParameters>(materials[k].model)) {
      g.sand.add(&g.sand_laws[k]);
      g.sand_points.push_back(point);
    } else if (std::holds_alternative<Pm4SiltParameters>(materials[k].model)) {
      g.silt.add(&g.silt_laws[k]);
      g.silt_points.push_back(point);
    } else {
      g.elastic.add(&g.elastic_laws[k]);
      g.elastic_points.push_back(point);
    }
  }
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
      [&](auto& group, std::size_t i, std::size_t point) { group.set_stress(i, row(effective_stress, point)); });
}

void MaterialPoints::start_elastic_stage(std::span<const double> poisson_override) {
  if (!poisson_override.empty()) {
    require_size(poisson_override.size(), groups_->materials.size(), "poisson_override");
  }
  groups_->for_each([&](auto& group, std::size_t i, std::size_t point) {
    const double keep = std::numeric_limits<double>::quiet_NaN();
    group.start_elastic_stage(i, poisson_override.empty() ? keep : poisson_override[groups_->material_of_point[point]]);
  });
}

void MaterialPoints::start_plastic_stage(bool recompute_limits) {
  groups_->for_each([&](auto& group, std::size_t i, std::size_t) { group.start_plastic_stage(i, recompute_limits); });
}

void MaterialPoints::set_post_shaking(bool on) {
  for (Pm4SandLaw& law : groups_->sand_laws) law.post_shaking = on;
  for (Pm4SiltLaw& law : groups_->silt_laws) law.post_shaking = on;
  groups_->for_each([](auto& group, std::size_t i, std::size_t) { group.refresh_moduli(i); });
}

UpdateReport MaterialPoints::update(std::span<const double> strain_increment, std::span<double> effective_stress) {
  require_size(strain_increment.size(), 3 * size(), "strain_increment");
  require_size(effective_stress.size(), 4 * size(), "effective_stress");
  const auto start = std::chrono::steady_clock::now();
  long substeps = 0;
  int failed = std::numeric_limits<int>::max();
  // Liquefied points cost a hundred times a settled one, so work is handed out in small blocks; every point's result is
  // its own, so the order does not matter. A single block is not worth waking the other threads.
  groups_->for_each_group([&](auto& group, const std::vector<std::size_t>& points) {
    const auto update_points = [&](long block, long& work, int& first_failure) {
      const std::size_t first = update_block * static_cast<std::size_t>(block);
      const std::size_t count = std::min(update_block, points.size() - first);
      std::array<StrainIncrement, update_block> strain;
      std::array<long, update_block> done;
      for (std::size_t k = 0; k < count; ++k) {
        const double* e = strain_increment.data() + 3 * points[first + k];
        strain[k] = {e[0], e[1], e[2]};
      }
      group.update(first, std::span(strain.data(), count), std::span(done.data(), count));
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t point = points[first + k];
        if (done[k] < 0) {
          first_failure = std::min(first_failure, static_cast<int>(point));
        } else {
          work += done[k];
        }
        store(group.trial_stress(first + k), effective_stress, point);
      }
    };
    const long blocks = static_cast<long>((points.size() + update_block - 1) / update_block);
    if (blocks <= 1) {
      if (blocks == 1) update_points(0, substeps, failed);
      return;
    }
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : substeps) reduction(min : failed)
    for (long block = 0; block < blocks; ++block) update_points(block, substeps, failed);
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
  groups_->for_each([](auto& group, std::size_t i, std::size_t) { group.commit(i); });
}

void MaterialPoints::committed_stress(std::span<double> effective_stress) const {
  require_size(effective_stress.size(), 4 * size(), "effective_stress");
  groups_->for_each([&](auto& group, std::size_t i, std::size_t point) {
    store(group.committed_stress(i), effective_stress, point);
  });
}

void MaterialPoints::elastic_moduli(std::span<double> bulk, std::span<double> shear) const {
  groups_->for_each([&](auto& group, std::size_t i, std::size_t point) {
    bulk[point] = group.bulk(i);
    shear[point] = group.shear(i);
  });
}

void MaterialPoints::initial_moduli(std::span<double> bulk, std::span<double> shear) const {
  groups_->for_each([&](auto& group, std::size_t i, std::size_t point) {
    bulk[point] = group.initial_bulk(i);
    shear[point] = group.initial_shear(i);
  });
}

void MaterialPoints::density(std::span<double> out) const {
  for (std::size_t i = 0; i < size(); ++i) out[i] = density_of(groups_->materials[groups_->material_of_point[i]]);
}

void MaterialPoints::porosity(std::span<double> out) const {
  for (std::size_t i = 0; i < size(); ++i) out[i] = porosity_of(groups_->materials[groups_->material_of_point[i]]);
}

std::size_t MaterialPoints::state_size() const {
  return std::max(
      {decltype(groups_->sand)::state_size, decltype(groups_->silt)::state_size, ElasticPlasticGroup::state_size});
}

std::vector<double> MaterialPoints::save_state() const {
  std::vector<double> state(size() * state_size(), 0.0);
  groups_->for_each(
      [&](auto& group, std::size_t i, std::size_t point) { group.save(i, state.data() + point * state_size()); });
  return state;
}

const std::vector<std::string>& MaterialPoints::internal_variable_names() {
  return internal_variable_name_list();
}

void MaterialPoints::internal_variable(std::string_view name, std::span<double> out) const {
  const std::vector<std::string>& names = internal_variable_name_list();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError("no internal variable is called '" + std::string(name) + "'." + did_you_mean(name, names) +
                     " Known: " + joined(names));
  }
  require_size(out.size(), size(), "internal_variable's result");
  const auto which = static_cast<InternalVariable>(found - names.begin());
  groups_->for_each(
      [&](auto& group, std::size_t i, std::size_t point) { out[point] = group.internal_variable(i, which); });
}

void MaterialPoints::restore_state(std::span<const double> state) {
  require_size(state.size(), size() * state_size(), "saved state");
  groups_->for_each(
      [&](auto& group, std::size_t i, std::size_t point) { group.restore(i, state.data() + point * state_size()); });
}

}  // namespace tailrun::fem

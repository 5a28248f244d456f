#include "common/particles.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "common/file_format.hpp"
#include "common/vtkhdf.hpp"

namespace tailrun {
namespace {

constexpr const char* format_name = "tailrun-particles";
const std::string data = "/VTKHDF/PointData/";

// One row per field: the one place that knows its name, shape, unit and meaning, for writer and reader alike.
// `columns` 0 is a scalar, -1 stands for the number of stress components.
struct Field {
  std::vector<double> ParticleSet::*values;
  std::string name;
  int columns;
  std::string unit;
  std::string description;
  bool positive = false;
  bool optional = false;
};

const std::vector<Field>& fields() {
  static const std::vector<Field> table = {
      {&ParticleSet::velocity, "velocity", 3, "m/s", "velocity relative to the base"},
      {&ParticleSet::mass, "mass", 0, "kg", "mass (plane strain: per metre of thickness)", true},
      {&ParticleSet::volume, "volume", 0, "m3", "current volume (plane strain: per metre of thickness)", true},
      {&ParticleSet::effective_stress, "effective_stress", -1, "Pa",
       "effective stress xx, yy, zz, xy[, yz, zx], tension positive"},
      {&ParticleSet::pore_pressure, "pore_pressure", 0, "Pa", "pore pressure, compression positive"},
      {&ParticleSet::initial_vertical_effective_stress, "initial_vertical_effective_stress", 0, "Pa",
       "sigma'_v0 before shaking, compression positive", false, true},
      {&ParticleSet::depth, "depth", 0, "m", "depth below the initial ground surface", false, true},
      {&ParticleSet::excess_pore_pressure_ratio, "excess_pore_pressure_ratio", 0, "1", "r_u at the transfer", false,
       true},
      {&ParticleSet::residual_strength, "residual_strength", 0, "Pa", "s_R where assigned, 0 elsewhere", false, true},
      {&ParticleSet::plastic_deviatoric_strain, "plastic_deviatoric_strain", 0, "1",
       "accumulated plastic deviatoric strain", false, true},
      {&ParticleSet::displacement, "displacement", 3, "m", "displacement since the start of the motion", false, true},
  };
  return table;
}

std::size_t file_columns(const Field& field, const ParticleSet& particles) {
  return field.columns < 0 ? static_cast<std::size_t>(particles.components()) : static_cast<std::size_t>(field.columns);
}

const std::string pond_group = "/tailrun/ponds";

void write_ponds(Hdf5Writer& file, const std::vector<PondedReach>& ponds) {
  std::vector<std::string> names;
  std::vector<double> level, extent, density;
  std::vector<std::int32_t> endless;
  for (const auto& pond : ponds) {
    names.push_back(pond.name);
    level.push_back(pond.level);
    density.push_back(pond.density);
    extent.insert(extent.end(), pond.extent.begin(), pond.extent.end());
    endless.insert(endless.end(), pond.endless.begin(), pond.endless.end());
  }
  file.group(pond_group);
  file.write_texts(pond_group + "/name", names, "names of the ponds");
  file.write(pond_group + "/level", std::span<const double>(level), 0, "m", "level of the water");
  file.write(pond_group + "/extent", std::span<const double>(extent), 2, "m", "from x to x");
  file.write(pond_group + "/endless", std::span<const std::int32_t>(endless), 2, "1",
             "1: the water goes on beyond that end");
  file.write(pond_group + "/density", std::span<const double>(density), 0, "kg/m3", "of the water");
}

std::vector<PondedReach> read_ponds(const Hdf5Reader& file) {
  const auto names = file.texts(pond_group + "/name");
  const std::size_t n = names.size();
  if (n == 0) file.fail(pond_group + "/name", "has no rows, but at least one pond is required");
  const auto level = file.doubles(pond_group + "/level", n, 1), extent = file.doubles(pond_group + "/extent", n, 2);
  const auto density = file.doubles(pond_group + "/density", n, 1);
  const auto endless = file.integers(pond_group + "/endless", n, 2);
  check_indices(file, pond_group + "/endless", endless, 0, 2);
  check_positive(file, pond_group + "/density", density);
  std::vector<PondedReach> ponds(n);
  for (std::size_t k = 0; k < n; ++k) {
    ponds[k] = {names[k],
                level[k],
                {extent[2 * k], extent[2 * k + 1]},
                {endless[2 * k] != 0, endless[2 * k + 1] != 0},
                density[k]};
    if (!(extent[2 * k + 1] > extent[2 * k]))
      file.fail(pond_group + "/extent",
                fmt::format("row {} ends at {:g} m, where it begins or before", k, extent[2 * k + 1]));
  }
  return ponds;
}

void check_lengths(const ParticleSet& particles) {
  const std::size_t n = particles.count();
  const auto require = [](bool holds, const std::string& name) {
    if (!holds) throw std::logic_error("write_particles: wrong length of " + name);
  };
  require(particles.position.size() == 3 * n, "position");
  require(particles.material_id.size() == n, "material_id");
  require(particles.region_id.empty() || particles.region_id.size() == n, "region_id");
  require(particles.source_element.empty() || particles.source_element.size() == n, "source_element");
  require(particles.strength_law.empty() || particles.strength_law.size() == n, "strength_law");
  for (const auto& field : fields()) {
    const std::size_t size = (particles.*field.values).size();
    const std::size_t columns = std::max<std::size_t>(file_columns(field, particles), 1);
    require(size == n * columns || (field.optional && size == 0), field.name);
  }
  for (const auto& [name, values] : particles.extra) require(values.size() == n, name);
}

}  // namespace

void write_particles(const std::filesystem::path& path, const ParticleSet& particles, const Provenance& provenance,
                     Precision precision) {
  check_lengths(particles);
  Hdf5Writer file(path);
  std::vector<std::int64_t> vertices(particles.count());
  std::iota(vertices.begin(), vertices.end(), 0);
  write_unstructured_grid(file, particles.position, vertices, 1, vtk_vertex);
  file.store_singles(precision == Precision::single);
  for (const auto& field : fields()) {
    const auto& values = particles.*field.values;
    if (values.empty() && field.optional) continue;
    file.write(data + field.name, std::span<const double>(values), file_columns(field, particles), field.unit,
               field.description);
  }
  file.write(data + "material_id", std::span<const std::int32_t>(particles.material_id), 0, "1",
             "index into /tailrun/material_names");
  if (!particles.region_id.empty())
    file.write(data + "region_id", std::span<const std::int32_t>(particles.region_id), 0, "1",
               "index into /tailrun/region_names");
  if (!particles.source_element.empty())
    file.write(data + "source_element", std::span<const std::int64_t>(particles.source_element), 0, "1",
               "element of the snapshot, -1 when none");
  if (!particles.strength_law.empty())
    file.write(data + "strength_law", std::span<const std::int32_t>(particles.strength_law), 0, "1",
               "index into /tailrun/strength_laws, -1 when none");
  for (const auto& [name, values] : particles.extra) {
    const auto unit = particles.extra_unit.find(name);
    file.write(data + name, std::span<const double>(values), 0, unit == particles.extra_unit.end() ? "1" : unit->second,
               "further field of the program that wrote this file");
  }
  file.store_singles(false);

  write_format(file, format_name, particles_format_version);
  file.attribute("/tailrun", "dimension", static_cast<double>(particles.dimension));
  file.attribute("/tailrun", "time_s", particles.time);
  file.attribute("/tailrun", "transfer_time_s", particles.transfer_time);
  file.attribute("/tailrun", "particle_size_m", particles.particle_size);
  file.write_texts("/tailrun/material_names", particles.material_names, "names of the materials");
  file.write_texts("/tailrun/region_names", particles.region_names, "names of the FEM regions");
  if (!particles.strength_law.empty())
    file.write_texts("/tailrun/strength_laws", particles.strength_laws,
                     "JSON: laws of the residual strength, with all inputs");
  file.group("/tailrun/terrain");
  for (const auto& line : particles.terrain)
    file.write("/tailrun/terrain/" + line.name, std::span<const double>(line.points), 2, "m",
               "polyline x, y; material may be on its left-hand side");
  if (!particles.ponds.empty()) write_ponds(file, particles.ponds);
  file.group("/tailrun/notes");
  for (const auto& [name, text] : particles.notes)
    file.write_texts("/tailrun/notes/" + name, {text}, "text of the program that wrote this file");
  write_provenance(file, provenance);
  file.commit();
}

ParticleSet read_particles(const std::filesystem::path& path) {
  const Hdf5Reader file(path);
  check_format(file, format_name, particles_format_version);
  ParticleSet particles;
  const double dimension = file.number_attribute("/tailrun", "dimension");
  if (dimension != 2.0 && dimension != 3.0)
    file.fail("/tailrun", fmt::format("attribute 'dimension' is {:g}, but 2 or 3 is required", dimension));
  particles.dimension = static_cast<int>(dimension);
  particles.time = file.number_attribute("/tailrun", "time_s");
  particles.transfer_time = file.number_attribute("/tailrun", "transfer_time_s");
  particles.particle_size = file.number_attribute("/tailrun", "particle_size_m");
  if (particles.particle_size < 0.0)
    file.fail("/tailrun",
              fmt::format("particle_size_m is {:g}, but 0 (not known) or more is required", particles.particle_size));
  particles.material_names = file.texts("/tailrun/material_names");
  particles.region_names = file.texts("/tailrun/region_names");
  particles.position = file.doubles("/VTKHDF/Points", 0, 3);
  const std::size_t n = particles.position.size() / 3;
  if (n == 0) file.fail("/VTKHDF/Points", "has no rows, but at least one particle is required");

  std::vector<std::string> known = {"material_id", "region_id", "source_element", "strength_law"};
  for (const auto& field : fields()) {
    known.push_back(field.name);
    const std::string name = data + field.name;
    if (field.optional && !file.has(name)) continue;
    particles.*field.values = file.doubles(name, n, std::max<std::size_t>(file_columns(field, particles), 1));
    if (field.positive) check_positive(file, name, particles.*field.values);
  }
  const auto materials = file.integers(data + "material_id", n, 1);
  check_indices(file, data + "material_id", materials, 0, static_cast<std::int64_t>(particles.material_names.size()));
  particles.material_id.assign(materials.begin(), materials.end());
  if (file.has(data + "region_id")) {
    const auto regions = file.integers(data + "region_id", n, 1);
    check_indices(file, data + "region_id", regions, -1, static_cast<std::int64_t>(particles.region_names.size()));
    particles.region_id.assign(regions.begin(), regions.end());
  }
  if (file.has(data + "source_element")) particles.source_element = file.integers(data + "source_element", n, 1);
  if (file.has(data + "strength_law")) {
    particles.strength_laws = file.texts("/tailrun/strength_laws");
    const auto laws = file.integers(data + "strength_law", n, 1);
    check_indices(file, data + "strength_law", laws, -1, static_cast<std::int64_t>(particles.strength_laws.size()));
    particles.strength_law.assign(laws.begin(), laws.end());
  }
  for (const auto& name : file.members("/VTKHDF/PointData")) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    particles.extra[name] = file.doubles(data + name, n, 1);
    if (file.has_attribute(data + name, "unit")) particles.extra_unit[name] = file.text_attribute(data + name, "unit");
  }
  for (const auto& name : file.members_if("/tailrun/terrain")) {
    TerrainLine line{name, file.doubles("/tailrun/terrain/" + name, 0, 2)};
    if (line.points.size() < 4) file.fail("/tailrun/terrain/" + name, "is a line of fewer than 2 points");
    particles.terrain.push_back(std::move(line));
  }
  if (file.has(pond_group)) particles.ponds = read_ponds(file);
  for (const auto& name : file.members_if("/tailrun/notes")) {
    const auto texts = file.texts("/tailrun/notes/" + name);
    if (!texts.empty()) particles.notes[name] = texts.front();
  }
  return particles;
}

}  // namespace tailrun

#include "common/snapshot.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "common/error.hpp"
#include "common/file_format.hpp"
#include "common/vtkhdf.hpp"

namespace tailrun {
namespace {

constexpr const char* format_name = "tailrun-snapshot";
const std::string points = "/VTKHDF/PointData/";
const std::string cells = "/VTKHDF/CellData/";

// One row per field: the one place that knows its name, shape, unit and meaning, for writer and reader alike.
struct Field {
  std::vector<double> Snapshot::*values;
  std::string name;
  std::size_t columns;  // in the file; vectors of the plane get a third, zero component there, as VTK wants
  std::string unit;
  std::string description;
  bool of_nodes;
};

const std::vector<Field>& fields() {
  static const std::vector<Field> table = {
      {&Snapshot::displacement, "displacement", 3, "m", "displacement since the start of shaking", true},
      {&Snapshot::velocity, "velocity", 3, "m/s", "velocity of the skeleton, absolute", true},
      {&Snapshot::acceleration, "acceleration", 3, "m/s2", "acceleration of the skeleton, absolute", true},
      {&Snapshot::pore_pressure, "pore_pressure", 0, "Pa", "pore pressure, compression positive", true},
      {&Snapshot::excess_pore_pressure, "excess_pore_pressure", 0, "Pa", "pore pressure minus its geostatic value",
       true},
      {&Snapshot::thickness, "thickness", 0, "m", "out-of-plane thickness", false},
      {&Snapshot::density, "density", 0, "kg/m3", "total density of the mixture", false},
      {&Snapshot::porosity, "porosity", 0, "1", "porosity", false},
      {&Snapshot::effective_stress, "effective_stress", 4, "Pa", "effective stress xx, yy, zz, xy, tension positive",
       false},
      {&Snapshot::total_stress, "total_stress", 4, "Pa", "total stress xx, yy, zz, xy, tension positive", false},
      {&Snapshot::initial_effective_stress, "initial_effective_stress", 4, "Pa",
       "geostatic effective stress xx, yy, zz, xy, tension positive", false},
      {&Snapshot::initial_vertical_effective_stress, "initial_vertical_effective_stress", 0, "Pa",
       "sigma'_v0, geostatic vertical effective stress, compression positive", false},
      {&Snapshot::initial_pore_pressure, "initial_pore_pressure", 0, "Pa", "geostatic pore pressure, mean of the nodes",
       false},
      {&Snapshot::depth, "depth", 0, "m", "depth of the centre below the initial ground surface", false},
      {&Snapshot::excess_pore_pressure_ratio, "excess_pore_pressure_ratio", 0, "1",
       "r_u = excess pore pressure / max(sigma'_v0, 5 kPa), 0 where not saturated", false},
      {&Snapshot::max_excess_pore_pressure_ratio, "max_excess_pore_pressure_ratio", 0, "1", "largest r_u so far",
       false},
      {&Snapshot::effective_stress_ratio, "effective_stress_ratio", 0, "1", "1 - sigma'_v / sigma'_v0", false},
      {&Snapshot::shear_strain, "shear_strain", 0, "1", "sqrt((exx - eyy)^2 + gxy^2) since the start of shaking",
       false},
      {&Snapshot::scaled_jacobian, "scaled_jacobian", 0, "1", "scaled Jacobian of the deformed element", false},
  };
  return table;
}

// (n, 3) to (n, 2).
std::vector<double> without_third(const std::vector<double>& space) {
  std::vector<double> plane(space.size() / 3 * 2);
  for (std::size_t i = 0; i < space.size() / 3; ++i) {
    plane[2 * i] = space[3 * i];
    plane[2 * i + 1] = space[3 * i + 1];
  }
  return plane;
}

std::vector<PondedLines> read_ponds(const Hdf5Reader& file, const Snapshot& snapshot) {
  const auto texts = file.texts("/tailrun/ponds/lines");
  const auto level = file.doubles("/tailrun/ponds/level", texts.size(), 1);
  std::vector<std::string> known;
  for (const auto& line : snapshot.lines) known.push_back(line.name);
  std::vector<PondedLines> ponds;
  for (std::size_t k = 0; k < texts.size(); ++k) {
    PondedLines pond{level[k], {}};
    std::istringstream stream(texts[k]);
    for (std::string name; std::getline(stream, name, '|');) {
      if (std::find(known.begin(), known.end(), name) == known.end())
        file.fail("/tailrun/ponds/lines", fmt::format("row {} names line '{}', which /tailrun/lines does not have.{}",
                                                      k, name, did_you_mean(name, known)));
      pond.lines.push_back(name);
    }
    ponds.push_back(std::move(pond));
  }
  return ponds;
}

}  // namespace

void write_snapshot(const std::filesystem::path& path, const Snapshot& snapshot, const Provenance& provenance,
                    const std::function<void(Hdf5Writer&)>& also) {
  for (const auto& field : fields()) {
    const std::size_t rows = field.of_nodes ? snapshot.nodes() : snapshot.elements();
    const std::size_t columns = field.columns == 3 ? 2 : field.columns == 0 ? 1 : field.columns;
    if ((snapshot.*field.values).size() != rows * columns)
      throw std::logic_error("write_snapshot: wrong length of " + field.name);
  }
  if (snapshot.quads.size() != 4 * snapshot.elements()) throw std::logic_error("write_snapshot: wrong length of quads");

  Hdf5Writer file(path);
  write_unstructured_grid(file, with_third(snapshot.position), snapshot.quads, 4, vtk_quad);
  for (const auto& field : fields()) {
    const auto& values = snapshot.*field.values;
    const std::string name = (field.of_nodes ? points : cells) + field.name;
    if (field.columns == 3)
      file.write(name, std::span<const double>(with_third(values)), 3, field.unit, field.description);
    else
      file.write(name, std::span<const double>(values), field.columns, field.unit, field.description);
  }
  file.write(cells + "region_id", std::span<const std::int32_t>(snapshot.region_id), 0, "1",
             "index into /tailrun/region_names");

  write_format(file, format_name, snapshot_format_version);
  file.attribute("/tailrun", "time_s", snapshot.time);
  file.attribute("/tailrun", "gravity_m_s2", snapshot.gravity);
  file.attribute("/tailrun", "fluid_density_kg_m3", snapshot.fluid_density);
  file.write("/tailrun/base_velocity", std::span<const double>(snapshot.base_velocity), 0, "m/s",
             "mean velocity of the base nodes");
  file.write_texts("/tailrun/region_names", snapshot.region_names, "names of the regions (gmsh physical surfaces)");
  file.write("/tailrun/phreatic_line", std::span<const double>(snapshot.phreatic_line), 2, "m",
             "polyline x, y of the phreatic line");
  if (!snapshot.ponds.empty()) {
    file.group("/tailrun/ponds");
    std::vector<double> level;
    std::vector<std::string> lines;
    for (const auto& pond : snapshot.ponds) {
      level.push_back(pond.level);
      lines.push_back(fmt::format("{}", fmt::join(pond.lines, "|")));
    }
    file.write("/tailrun/ponds/level", std::span<const double>(level), 0, "m", "level of the water");
    file.write_texts("/tailrun/ponds/lines", lines, "named lines that it stands on, separated by '|'");
  }
  file.group("/tailrun/lines");
  for (const auto& line : snapshot.lines)
    file.write("/tailrun/lines/" + line.name, std::span<const std::int64_t>(line.edges), 2, "1",
               "edges of this named line: pairs of node numbers");
  write_provenance(file, provenance);
  if (also) also(file);
  file.commit();
}

Snapshot read_snapshot(const std::filesystem::path& path) {
  const Hdf5Reader file(path);
  check_format(file, format_name, snapshot_format_version);
  Snapshot snapshot;
  snapshot.time = file.number_attribute("/tailrun", "time_s");
  snapshot.gravity = file.number_attribute("/tailrun", "gravity_m_s2");
  snapshot.fluid_density = file.number_attribute("/tailrun", "fluid_density_kg_m3");
  if (snapshot.gravity < 0.0 || snapshot.fluid_density <= 0.0)
    file.fail(
        "/tailrun",
        fmt::format("gravity_m_s2 is {:g} and fluid_density_kg_m3 {:g}, but 0 or more (downwards) and more than 0 are "
                    "required",
                    snapshot.gravity, snapshot.fluid_density));
  const auto base_velocity = file.doubles("/tailrun/base_velocity", 2, 1);
  snapshot.base_velocity = {base_velocity[0], base_velocity[1]};
  snapshot.region_names = file.texts("/tailrun/region_names");
  if (file.shape("/tailrun/phreatic_line")[0] > 0)
    snapshot.phreatic_line = file.doubles("/tailrun/phreatic_line", 0, 2);

  const auto position = file.doubles("/VTKHDF/Points", 0, 3);
  snapshot.position = without_third(position);
  const std::size_t nodes = snapshot.nodes();
  const std::size_t elements = file.shape(cells + "region_id")[0];
  if (nodes == 0) file.fail("/VTKHDF/Points", "has no rows, but at least one node is required");
  if (elements == 0) file.fail(cells + "region_id", "has no rows, but at least one element is required");
  snapshot.quads = file.integers("/VTKHDF/Connectivity", 4 * elements, 1);
  check_indices(file, "/VTKHDF/Connectivity", snapshot.quads, 0, static_cast<std::int64_t>(nodes));
  const auto regions = file.integers(cells + "region_id", elements, 1);
  check_indices(file, cells + "region_id", regions, 0, static_cast<std::int64_t>(snapshot.region_names.size()));
  snapshot.region_id.assign(regions.begin(), regions.end());

  for (const auto& field : fields()) {
    const std::string name = (field.of_nodes ? points : cells) + field.name;
    auto values = file.doubles(name, field.of_nodes ? nodes : elements, field.columns ? field.columns : 1);
    if (field.name == "density" || field.name == "thickness") check_positive(file, name, values);
    snapshot.*field.values = field.columns == 3 ? without_third(values) : std::move(values);
  }
  for (const auto& name : file.members_if("/tailrun/lines")) {
    MeshLine line{name, file.integers("/tailrun/lines/" + name, 0, 2)};
    check_indices(file, "/tailrun/lines/" + name, line.edges, 0, static_cast<std::int64_t>(nodes));
    snapshot.lines.push_back(std::move(line));
  }
  if (file.has("/tailrun/ponds")) snapshot.ponds = read_ponds(file, snapshot);
  return snapshot;
}

}  // namespace tailrun

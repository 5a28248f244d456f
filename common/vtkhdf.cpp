#include "common/vtkhdf.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "common/application.hpp"
#include "common/json_text.hpp"

namespace tailrun {

void write_unstructured_grid(Hdf5Writer& file, std::span<const double> points,
                             std::span<const std::int64_t> connectivity, std::size_t nodes_per_cell,
                             std::uint8_t cell_type) {
  const std::size_t cells = connectivity.size() / nodes_per_cell;
  file.group("/VTKHDF");
  const std::int64_t format_version[2] = {1, 0};
  file.attribute("/VTKHDF", "Version", std::span<const std::int64_t>(format_version));
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));

  const auto count = [&](const std::string& name, std::size_t value, const std::string& description) {
    const std::int64_t one[1] = {static_cast<std::int64_t>(value)};
    file.write("/VTKHDF/" + name, std::span<const std::int64_t>(one), 0, "1", description);
  };
  count("NumberOfPoints", points.size() / 3, "number of points");
  count("NumberOfCells", cells, "number of cells");
  count("NumberOfConnectivityIds", connectivity.size(), "length of Connectivity");

  std::vector<std::int64_t> offsets(cells + 1);
  for (std::size_t i = 0; i <= cells; ++i) offsets[i] = static_cast<std::int64_t>(i * nodes_per_cell);
  const std::vector<std::uint8_t> types(cells, cell_type);
  file.write("/VTKHDF/Points", points, 3, "m", "coordinates");
  file.write("/VTKHDF/Connectivity", connectivity, 0, "1", "point numbers of the cells, one cell after the other");
  file.write("/VTKHDF/Offsets", std::span<const std::int64_t>(offsets), 0, "1", "start of each cell in Connectivity");
  file.write("/VTKHDF/Types", std::span<const std::uint8_t>(types), "1", "VTK cell types: 1 vertex, 9 quadrilateral");
  file.group("/VTKHDF/PointData");
  file.group("/VTKHDF/CellData");
}

std::vector<double> with_third(std::span<const double> plane) {
  std::vector<double> space(plane.size() / 2 * 3, 0.0);
  for (std::size_t i = 0; i < plane.size() / 2; ++i) {
    space[3 * i] = plane[2 * i];
    space[3 * i + 1] = plane[2 * i + 1];
  }
  return space;
}

void write_file_series(const std::filesystem::path& path, const std::vector<std::string>& names,
                       const std::vector<double>& times) {
  nlohmann::ordered_json index;
  index["file-series-version"] = "1.0";
  index["files"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < names.size(); ++k) index["files"].push_back({{"name", names[k]}, {"time", times[k]}});
  write_text_file(path.string(), text_of_json(index, 1) + "\n");
}

}  // namespace tailrun

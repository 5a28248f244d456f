// The VTKHDF v1 skeleton (static UnstructuredGrid) that both of our file formats are built on, so that ParaView 5.11
// opens them as they are. https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html, "VTKHDF".
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/hdf5_file.hpp"

namespace tailrun {

constexpr std::uint8_t vtk_vertex = 1;
constexpr std::uint8_t vtk_quad = 9;

// Writes the group /VTKHDF with points (m, (n, 3)) and cells of one type, `nodes_per_cell` each; `connectivity` is
// (cells, nodes_per_cell). PointData and CellData groups are made; fields go there by Hdf5Writer::write.
void write_unstructured_grid(Hdf5Writer& file, std::span<const double> points,
                             std::span<const std::int64_t> connectivity, std::size_t nodes_per_cell,
                             std::uint8_t cell_type);

// (n, 2) to (n, 3) with a zero third component: VTK's vectors have three.
std::vector<double> with_third(std::span<const double> plane);

// The index that ParaView opens as one series in time: `path` ends in ".vtkhdf.series" and lies beside the files, whose
// own names may end otherwise. Times in s. Throws as write_text_file does.
void write_file_series(const std::filesystem::path& path, const std::vector<std::string>& names,
                       const std::vector<double>& times);

}  // namespace tailrun

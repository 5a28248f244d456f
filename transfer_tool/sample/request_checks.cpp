#include "transfer_tool/sample/request_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/machine_memory.hpp"
#include "transfer_tool/sample/mesh_geometry.hpp"

namespace tailrun::transfer {

namespace {

constexpr double bytes_per_point = 450.0;  // in memory: sample, mapped state, particle set; measured 417
constexpr double bytes_in_file = 6.0;      // of a point on disk, at least: a column at rest packs to 6.5
constexpr double most_points = 1e9;        // indices of the particle stage have 32 bits

// The key that decides on the number of points.
std::pair<CaseNode, std::string> deciding_key(const CaseFile& file, const std::string& size,
                                              const SamplingOptions& options) {
  const CaseNode root = file.root(), sampling = root.object_or_empty("sampling");
  const bool by_size = std::any_of(options.points.begin(), options.points.end(), [](int n) { return n == 0; });
  if (!by_size) return {sampling, sampling.has("points") ? "points" : "points_by_region"};
  for (const auto& [name, node] : root.object_or_empty("sizes").members())
    if (name == size && node.has("cell_size")) return {node, "cell_size"};
  return {sampling, "cell_size"};
}

}  // namespace

double points_asked_for(const Snapshot& snapshot, const std::vector<bool>& kept, const SamplingOptions& options) {
  double count = 0.0;
  for (std::size_t e = 0; e < snapshot.elements(); ++e)
    if (kept[e]) {
      const auto [along, across] =
          points_in_element(deformed_corners(snapshot, e), options, static_cast<std::size_t>(snapshot.region_id[e]));
      count += along * across;
    }
  return count;
}

void check_request(const CaseFile& file, const std::string& size, const Snapshot& snapshot,
                   const std::vector<bool>& kept, const SamplingOptions& options, const std::filesystem::path& output) {
  const double count = points_asked_for(snapshot, kept, options);
  const auto [node, key] = deciding_key(file, size, options);
  const double most = std::min(most_points, machine_memory() / bytes_per_point);
  const std::string asked = fmt::format("{:.3g} points (cells of {:g} m, {:g} points in each)", count,
                                        options.cell_size, options.points_per_cell);
  if (!(count <= most))
    node.fail(key, fmt::format("asks for {} of {:g} bytes, but this machine's memory of {:.3g} GB holds {:.3g}; larger "
                               "cells or fewer points are required",
                               asked, bytes_per_point, machine_memory() * 1e-9, most));
  if (output.empty()) return;
  std::error_code unknown;
  const auto folder = output.has_parent_path() ? output.parent_path() : std::filesystem::path(".");
  const auto space = std::filesystem::space(folder, unknown);
  const double bytes = count * bytes_in_file;
  if (!unknown && bytes > static_cast<double>(space.available))
    node.fail(key, fmt::format("asks for {}, which take {:.3g} GB or more, but {} has {:.3g} GB left", asked,
                               bytes * 1e-9, folder.string(), static_cast<double>(space.available) * 1e-9));
}

}  // namespace tailrun::transfer

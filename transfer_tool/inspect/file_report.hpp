// `transfer_tool info`: what any file of the chain holds.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tailrun::transfer {

struct FieldReport {
  std::string name, unit, description;
  std::vector<std::size_t> shape;
  // By column; a vector or tensor field has several. Empty for fields without values.
  std::vector<double> least, mean, most;
};

struct FileReport {
  std::filesystem::path path;
  std::string kind;  // "tailrun-snapshot", "tailrun-particles", or another tailrun file's own
  int format_version = 0;
  std::vector<std::pair<std::string, double>> numbers;      // time and other attributes of /tailrun
  std::string program, program_version;                     // provenance
  std::vector<std::pair<std::string, std::string>> inputs;  // name, SHA-256
  std::size_t points = 0, cells = 0;
  std::vector<double> low, high;  // m, bounds of the points
  std::optional<double> mass;     // kg (per metre in plane strain)
  struct Group {
    std::string what, name;  // "region" or "material"
    long count = 0;
    double mass = 0.0;
  };
  std::vector<Group> groups;
  std::vector<std::pair<std::string, std::size_t>> polylines;  // terrain and named lines, with their number of rows
  std::vector<std::pair<std::string, std::string>> notes;      // name, text
  std::vector<std::pair<std::string, std::vector<std::size_t>>> other;  // further datasets: restart states, checkpoints
  std::vector<FieldReport> fields;
};

// Throws InputError: missing, truncated, not HDF5, not of this toolchain, values that are not finite.
FileReport read_file_report(const std::filesystem::path& path);

std::string report_text(const FileReport& report);
nlohmann::ordered_json report_json(const FileReport& report);

}  // namespace tailrun::transfer

#include "transfer_tool/inspect/file_report.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"
#include "common/json_text.hpp"

namespace tailrun::transfer {
namespace {

const std::string points_of = "/VTKHDF/PointData/";
const std::string cells_of = "/VTKHDF/CellData/";

FieldReport read_field(const Hdf5Reader& file, const std::string& name) {
  FieldReport field;
  field.name = name;
  field.shape = file.shape(name);
  if (file.has_attribute(name, "unit")) field.unit = file.text_attribute(name, "unit");
  if (file.has_attribute(name, "description")) field.description = file.text_attribute(name, "description");
  const auto values = file.doubles(name);
  const std::size_t columns = field.shape.size() < 2 ? 1 : field.shape[1];
  const std::size_t rows = columns ? values.size() / columns : 0;
  if (rows == 0) return field;
  field.least.assign(columns, INFINITY);
  field.most.assign(columns, -INFINITY);
  field.mean.assign(columns, 0.0);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t k = 0; k < columns; ++k) {
      const double value = values[columns * i + k];
      field.least[k] = std::min(field.least[k], value);
      field.most[k] = std::max(field.most[k], value);
      field.mean[k] += value / static_cast<double>(rows);
    }
  return field;
}

// Every numeric dataset under `group`, in the file's order; lists of texts are skipped.
void read_fields(const Hdf5Reader& file, const std::string& group, std::vector<FieldReport>& fields) {
  if (!file.has(group)) return;
  for (const auto& name : file.members(group)) fields.push_back(read_field(file, group + name));
}

double mass_of_element(const std::vector<double>& x, const std::vector<std::int64_t>& quads, std::size_t e) {
  const auto at = [&](std::size_t corner, std::size_t k) {
    return x[3 * static_cast<std::size_t>(quads[4 * e + corner]) + k];
  };
  return 0.5 * ((at(2, 0) - at(0, 0)) * (at(3, 1) - at(1, 1)) - (at(2, 1) - at(0, 1)) * (at(3, 0) - at(1, 0)));
}

std::vector<double> masses(const Hdf5Reader& file, const FileReport& report) {
  if (file.has(points_of + "mass")) return file.doubles(points_of + "mass", report.points, 1);
  if (!file.has(cells_of + "density") || !file.has(cells_of + "thickness")) return {};
  const auto density = file.doubles(cells_of + "density", report.cells, 1);
  const auto thickness = file.doubles(cells_of + "thickness", report.cells, 1);
  const auto x = file.doubles("/VTKHDF/Points", report.points, 3);
  const auto quads = file.integers("/VTKHDF/Connectivity", 4 * report.cells, 1);
  for (const std::int64_t node : quads)
    if (node < 0 || node >= static_cast<std::int64_t>(report.points))
      file.fail("/VTKHDF/Connectivity", fmt::format("point {} does not exist", node));
  std::vector<double> result(report.cells);
  for (std::size_t e = 0; e < report.cells; ++e) result[e] = density[e] * thickness[e] * mass_of_element(x, quads, e);
  return result;
}

void read_groups(const Hdf5Reader& file, const std::string& what, const std::vector<double>& mass, FileReport& report) {
  const std::string names = "/tailrun/" + what + "_names";
  std::string ids = points_of + what + "_id";
  if (!file.has(ids)) ids = cells_of + what + "_id";
  if (!file.has(names) || !file.has(ids)) return;
  const std::size_t first = report.groups.size();
  for (const auto& name : file.texts(names)) report.groups.push_back({what, name, 0, 0.0});
  const auto values = file.integers(ids);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < 0) continue;
    const std::size_t place = first + static_cast<std::size_t>(values[i]);
    if (place >= report.groups.size()) file.fail(ids, fmt::format("entry {} is {}, but it has no name", i, values[i]));
    ++report.groups[place].count;
    if (i < mass.size()) report.groups[place].mass += mass[i];
  }
}

void read_grid(const Hdf5Reader& file, FileReport& report) {
  if (!file.has("/VTKHDF/Points")) return;
  const FieldReport points = read_field(file, "/VTKHDF/Points");
  report.points = points.shape[0];
  report.low = points.least;
  report.high = points.most;
  if (file.has("/VTKHDF/Types")) report.cells = file.shape("/VTKHDF/Types")[0];
}

void read_provenance(const Hdf5Reader& file, FileReport& report) {
  const std::string group = "/tailrun/provenance";
  if (file.has_attribute(group, "program")) report.program = file.text_attribute(group, "program");
  if (file.has_attribute(group, "version")) report.program_version = file.text_attribute(group, "version");
  if (!file.has(group + "/input_names") || !file.has(group + "/input_sha256")) return;
  const auto names = file.texts(group + "/input_names"), sums = file.texts(group + "/input_sha256");
  for (std::size_t i = 0; i < std::min(names.size(), sums.size()); ++i) report.inputs.emplace_back(names[i], sums[i]);
}

// Datasets that no part of the format describes, such as the restart state that a program keeps in a group of its own.
void read_other(const Hdf5Reader& file, const std::string& group, FileReport& report) {
  for (const auto& name : file.members(group)) {
    const std::string place = group + "/" + name;
    if (place == "/tailrun/provenance" || place == "/tailrun/notes" || place == "/tailrun/terrain" ||
        place == "/tailrun/ponds" || place == "/tailrun/lines" || place.ends_with("_names"))
      continue;
    if (file.is_group(place))
      read_other(file, place, report);
    else
      report.other.emplace_back(place, file.shape(place));
  }
}

std::string columns_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.5g}", text.empty() ? "" : ", ", value);
  return text;
}

}  // namespace

FileReport read_file_report(const std::filesystem::path& path) {
  const Hdf5Reader file(path);
  FileReport report;
  report.path = path;
  if (!file.has("/tailrun") || !file.has_attribute("/tailrun", "format"))
    throw InputError(
        fmt::format("{}: an HDF5 file, but not one of tailrun's: it has no group /tailrun with the "
                    "attribute 'format'",
                    path.string()));
  report.kind = file.text_attribute("/tailrun", "format");
  const double format_version = file.number_attribute("/tailrun", "format_version");
  if (format_version != std::floor(format_version) || std::abs(format_version) > 1e6)
    file.fail("/tailrun",
              fmt::format("attribute 'format_version' is {:g}, but a whole number is required", format_version));
  report.format_version = static_cast<int>(format_version);
  for (const char* name :
       {"time_s", "transfer_time_s", "dimension", "particle_size_m", "gravity_m_s2", "fluid_density_kg_m3", "step"})
    if (file.has_attribute("/tailrun", name))
      report.numbers.emplace_back(name, file.number_attribute("/tailrun", name));
  for (const char* name : {"name", "lines"})
    if (const std::string texts = fmt::format("/tailrun/ponds/{}", name); file.has(texts)) {
      const auto names = file.texts(texts);
      const auto level = file.doubles("/tailrun/ponds/level", names.size(), 1);
      for (std::size_t k = 0; k < names.size(); ++k)
        report.numbers.emplace_back(fmt::format("level_m of pond '{}'", names[k]), level[k]);
    }
  read_provenance(file, report);
  read_grid(file, report);
  const auto mass = masses(file, report);
  if (!mass.empty()) {
    report.mass = 0.0;
    for (const double value : mass) *report.mass += value;
  }
  read_groups(file, "region", mass, report);
  read_groups(file, "material", mass, report);
  for (const char* group : {"/tailrun/terrain", "/tailrun/lines"})
    if (file.has(group))
      for (const auto& name : file.members(group))
        report.polylines.emplace_back(name, file.shape(std::string(group) + "/" + name)[0]);
  if (file.has("/tailrun/notes"))
    for (const auto& name : file.members("/tailrun/notes"))
      for (const auto& text : file.texts("/tailrun/notes/" + name)) report.notes.emplace_back(name, text);
  read_other(file, "/tailrun", report);
  // A checkpoint has no grid: all that it holds lies in groups of its program's own.
  for (const auto& name : file.members("/"))
    if (const std::string group = "/" + name; name != "tailrun" && name != "VTKHDF" && file.is_group(group))
      read_other(file, group, report);
  read_fields(file, points_of, report.fields);
  read_fields(file, cells_of, report.fields);
  return report;
}

std::string report_text(const FileReport& report) {
  std::string text =
      fmt::format("{}: {}, format version {}\n", report.path.string(), report.kind, report.format_version);
  if (!report.program.empty()) text += fmt::format("  made by {} {}\n", report.program, report.program_version);
  for (const auto& [name, sum] : report.inputs) text += fmt::format("  from {}  sha256 {}\n", name, sum);
  for (const auto& [name, value] : report.numbers) text += fmt::format("  {} = {:g}\n", name, value);
  if (report.kind.find("checkpoint") != std::string::npos)
    text += "  a checkpoint: what a run that was stopped goes on from (--resume), without a grid to look at\n";
  else
    text += fmt::format("  {} points, {} cells\n", report.points, report.cells);
  if (!report.low.empty())
    text += fmt::format("  bounds ({}) to ({}) m\n", columns_of(report.low), columns_of(report.high));
  if (report.mass) text += fmt::format("  mass {:.8g} kg\n", *report.mass);
  if (!report.groups.empty()) text += fmt::format("\n  {:<9} {:<24} {:>9} {:>14}\n", "", "name", "count", "mass kg");
  for (const auto& group : report.groups)
    text += fmt::format("  {:<9} {:<24} {:>9} {:>14.6g}\n", group.what, group.name, group.count, group.mass);
  for (const auto& [name, rows] : report.polylines) text += fmt::format("  line {:<29} {:>9} rows\n", name, rows);
  for (const auto& [name, note] : report.notes)
    text += fmt::format("  note {:<29} {:>9} characters\n", name, note.size());
  for (const auto& [name, shape] : report.other)
    text += fmt::format("  data {:<29} {:>9}\n", name, fmt::format("{}", fmt::join(shape, " x ")));
  if (report.fields.empty()) return text;
  text += fmt::format("\n  {:<38} {:>6} {:>13} {:>13} {:>13}\n", "field", "unit", "min", "mean", "max");
  for (const auto& field : report.fields) {
    const std::string name = field.name.substr(field.name.rfind('/') + 1);
    for (std::size_t k = 0; k < field.mean.size(); ++k)
      text += fmt::format("  {:<38} {:>6} {:>13.5g} {:>13.5g} {:>13.5g}\n",
                          field.mean.size() == 1 ? name : fmt::format("{}[{}]", name, k), field.unit, field.least[k],
                          field.mean[k], field.most[k]);
  }
  return text;
}

nlohmann::ordered_json report_json(const FileReport& report) {
  nlohmann::ordered_json json = {{"file", report.path.string()},
                                 {"format", report.kind},
                                 {"format_version", report.format_version},
                                 {"program", report.program},
                                 {"program_version", report.program_version}};
  for (const auto& [name, sum] : report.inputs) json["inputs"].push_back({{"name", name}, {"sha256", sum}});
  for (const auto& [name, value] : report.numbers) json[name] = value;
  json["points"] = report.points;
  json["cells"] = report.cells;
  json["bounds_m"] = {{"low", report.low}, {"high", report.high}};
  if (report.mass) json["mass_kg"] = *report.mass;
  for (const auto& group : report.groups)
    json[group.what == "region" ? "regions" : "materials"].push_back(
        {{"name", group.name}, {"count", group.count}, {"mass_kg", group.mass}});
  for (const auto& [name, rows] : report.polylines) json["lines"].push_back({{"name", name}, {"rows", rows}});
  for (const auto& [name, note] : report.notes) {
    const auto parsed = json_or_null(note);
    json["notes"][name] = parsed.is_null() ? nlohmann::ordered_json(note) : parsed;
  }
  for (const auto& [name, shape] : report.other) json["other"].push_back({{"name", name}, {"shape", shape}});
  for (const auto& field : report.fields)
    json["fields"].push_back({{"name", field.name},
                              {"unit", field.unit},
                              {"description", field.description},
                              {"shape", field.shape},
                              {"min", field.least},
                              {"mean", field.mean},
                              {"max", field.most}});
  return json;
}

}  // namespace tailrun::transfer

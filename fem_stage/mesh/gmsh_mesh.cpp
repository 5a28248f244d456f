#include "fem_stage/mesh/gmsh_mesh.hpp"

#include <fmt/format.h>
#include <gmsh.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

constexpr int gmsh_line = 1, gmsh_quad = 3, gmsh_point = 15;

// gmsh's library has one global state; this owns it for the length of a call.
class Session {
 public:
  Session() : threads_(omp_get_max_threads()) {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);  // the same mesh on every machine
    gmsh::logger::start();
  }
  ~Session() {
    gmsh::finalize();
    omp_set_num_threads(threads_);  // gmsh sets OpenMP's number for the whole program
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  static std::string errors() {
    std::vector<std::string> log;
    gmsh::logger::get(log);
    std::string text;
    for (const auto& line : log)
      if (line.rfind("Error", 0) == 0) text += (text.empty() ? "" : "; ") + line;
    return text;
  }

 private:
  int threads_;
};

void open_or_throw(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path.string()));
  std::string reason;
  try {
    gmsh::open(path.string());
    reason = Session::errors();
  } catch (const std::exception& error) {
    reason = error.what();
  } catch (...) {
    reason = Session::errors();
    if (reason.empty()) reason = "gmsh cannot read it";
  }
  if (!reason.empty()) throw InputError(fmt::format("{}: {}", path.string(), reason));
}

// Node tags renumbered 0..N-1 in ascending order of tag, keeping only nodes of quadrilaterals.
Mesh mesh_of_current_model(const std::string& source) {
  Mesh mesh;
  gmsh::vectorpair surfaces;
  gmsh::model::getEntities(surfaces, 2);
  std::map<std::size_t, std::int64_t> number;  // of a node tag
  std::vector<std::size_t> quad_tags;
  for (const auto& [dimension, tag] : surfaces) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> element_tags, node_tags;
    gmsh::model::mesh::getElements(types, element_tags, node_tags, dimension, tag);
    if (types.empty()) continue;
    std::vector<int> groups;
    gmsh::model::getPhysicalGroupsForEntity(dimension, tag, groups);
    if (groups.size() != 1)
      throw InputError(
          fmt::format("{}: surface {} is in {} physical surfaces, but every meshed surface must be in exactly one (it "
                      "names the region)",
                      source, tag, groups.size()));
    std::string name;
    gmsh::model::getPhysicalName(2, groups[0], name);
    if (name.empty())
      throw InputError(
          fmt::format("{}: physical surface {} has no name; regions are chosen by name", source, groups[0]));
    auto it = std::find(mesh.region_names.begin(), mesh.region_names.end(), name);
    if (it == mesh.region_names.end()) it = mesh.region_names.insert(it, name);
    const auto region = static_cast<std::int32_t>(it - mesh.region_names.begin());
    for (std::size_t k = 0; k < types.size(); ++k) {
      if (types[k] != gmsh_quad) {
        std::string type_name;
        int d, order, nodes, primary;
        std::vector<double> local;
        gmsh::model::mesh::getElementProperties(types[k], type_name, d, order, nodes, local, primary);
        throw InputError(
            fmt::format("{}: surface {} (region '{}') has {} elements of type '{}', but only four-node quadrilaterals "
                        "are allowed; use Recombine Surface",
                        source, tag, name, element_tags[k].size(), type_name));
      }
      quad_tags.insert(quad_tags.end(), node_tags[k].begin(), node_tags[k].end());
      mesh.region.insert(mesh.region.end(), element_tags[k].size(), region);
      for (const auto node : node_tags[k]) number[node] = 0;
    }
  }
  std::int64_t next = 0;
  for (auto& [tag, n] : number) {
    n = next++;
    std::vector<double> position, parametric;
    gmsh::model::mesh::getNode(tag, position, parametric);
    mesh.position.insert(mesh.position.end(), {position[0], position[1]});
  }
  for (const auto tag : quad_tags) mesh.quads.push_back(number[tag]);

  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, 1);
  for (const auto& [dimension, group] : groups) {
    std::string name;
    gmsh::model::getPhysicalName(dimension, group, name);
    if (name.empty()) name = fmt::format("curve_{}", group);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, group, entities);
    for (const int entity : entities) {
      std::vector<int> types;
      std::vector<std::vector<std::size_t>> element_tags, node_tags;
      gmsh::model::mesh::getElements(types, element_tags, node_tags, dimension, entity);
      for (std::size_t k = 0; k < types.size(); ++k) {
        if (types[k] == gmsh_point) continue;
        if (types[k] != gmsh_line)
          throw InputError(fmt::format("{}: physical curve '{}' has elements other than two-node lines", source, name));
        for (std::size_t i = 0; i + 1 < node_tags[k].size(); i += 2) {
          const auto a = number.find(node_tags[k][i]), b = number.find(node_tags[k][i + 1]);
          if (a != number.end() && b != number.end()) mesh.lines[name].push_back({a->second, b->second});
        }
      }
    }
  }
  return mesh;
}

}  // namespace

Mesh mesh_geometry(const std::filesystem::path& geometry, const std::map<std::string, double>& parameters,
                   const std::filesystem::path& output) {
  const Session session;
  for (const auto& [name, value] : parameters) gmsh::onelab::setNumber("Parameters/" + name, {value});
  open_or_throw(geometry);
  try {
    gmsh::model::mesh::generate(2);
  } catch (...) {
    throw InputError(fmt::format("{}: gmsh cannot mesh it: {}", geometry.string(), Session::errors()));
  }
  Mesh mesh = mesh_of_current_model(geometry.string());
  check_mesh(mesh, geometry.string());
  if (!output.empty()) {
    gmsh::option::setNumber("Mesh.MshFileVersion", 4.1);
    gmsh::option::setNumber("Mesh.Binary", 0);
    if (!output.parent_path().empty()) std::filesystem::create_directories(output.parent_path());
    const auto temporary = output.parent_path() / (output.stem().string() + ".part.msh");
    gmsh::write(temporary.string());
    std::filesystem::rename(temporary, output);
  }
  return mesh;
}

Mesh read_gmsh(const std::filesystem::path& path) {
  const Session session;
  open_or_throw(path);
  Mesh mesh = mesh_of_current_model(path.string());
  check_mesh(mesh, path.string());
  return mesh;
}

}  // namespace tailrun::fem

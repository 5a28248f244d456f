#include "fem_stage/mesh/gmsh_mesh.hpp"

#include <fmt/core.h>
#include <gmsh.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/error.hpp"
#include "common/machine_memory.hpp"
#include "common/warnings.hpp"
#include "fem_stage/mesh/geo_commands.hpp"
#include "fem_stage/mesh/isolated.hpp"
#include "fem_stage/mesh/mesh_bytes.hpp"
#include "fem_stage/mesh/msh_audit.hpp"

namespace tailrun::fem {
namespace {

constexpr int gmsh_line = 1, gmsh_quad = 3, gmsh_point = 15;
constexpr double reading_time_limit = 600.0;  // s

// gmsh's library has one global state; this owns it for the length of a call. The user's ~/.gmshrc is left alone: with
// Mesh.ScalingFactor = 2 in it the dam would be twice as large.
class Session {
 public:
  Session() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);  // the same mesh on every machine
    gmsh::logger::start();
  }
  ~Session() { gmsh::finalize(); }
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
};

void require_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) throw InputError(fmt::format("{}: no such file", path.string()));
}

void open_or_throw(const std::filesystem::path& path) {
  std::string reason;
  try {
    gmsh::open(path.string());
    reason = Session::errors();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    reason = error.what();
  } catch (...) {
    reason = Session::errors();
    if (reason.empty()) reason = "gmsh cannot read it";
  }
  if (!reason.empty()) throw InputError(fmt::format("{}: {}", path.string(), reason));
}

std::array<std::int64_t, 4> ascending(const std::size_t* nodes) {
  std::array<std::int64_t, 4> key{};
  std::copy(nodes, nodes + 4, key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

// Entities that were reversed ("Physical Surface {-1}") have a negative number of their group, and the name of the
// positive one.
std::string name_of_group(int dimension, int group) {
  std::string name;
  gmsh::model::getPhysicalName(dimension, group, name);
  if (name.empty()) gmsh::model::getPhysicalName(dimension, std::abs(group), name);
  return name;
}

std::vector<int> groups_of_surface(int tag) {
  std::vector<int> groups;
  gmsh::model::getPhysicalGroupsForEntity(2, tag, groups);
  std::set<int> unique;
  for (const int group : groups) unique.insert(std::abs(group));
  return {unique.begin(), unique.end()};
}

[[noreturn]] void fail_type(const std::string& source, const std::string& where, int type, std::size_t count) {
  std::string name;
  int dimension, order, nodes, primary;
  std::vector<double> local;
  gmsh::model::mesh::getElementProperties(type, name, dimension, order, nodes, local, primary);
  throw InputError(
      fmt::format("{}: {} has {} elements of type '{}', but only {} are allowed; {}", source, where, count, name,
                  dimension == 1 ? "two-node lines" : "four-node quadrilaterals",
                  order > 1 ? fmt::format("they are of order {}: set Mesh.ElementOrder = 1 and mesh again", order)
                            : "use Recombine Surface"));
}

// The regions of one surface's quadrilaterals: by its physical surface, or, where a file of version 2 has several in
// one entity, by what each element says.
class RegionOf {
 public:
  RegionOf(const std::string& source, int surface, const MshGroups& groups)
      : source_(source), surface_(surface), given_(groups), groups_(groups_of_surface(surface)) {
    if (groups_.size() != 1 && (groups_.empty() || !groups.known))
      throw InputError(fmt::format(
          "{}: surface {} is in {} physical surfaces, but every meshed surface must be in exactly one (it names the "
          "region){}",
          source, surface, groups_.size(),
          groups_.empty() && groups.known
              ? "; 'Save all elements' loses the groups in format 2: save without it, or as 4.1"
              : ""));
  }
  int group(const std::size_t* nodes) const {
    if (groups_.size() == 1) return groups_.front();
    const auto it = given_.quadrilaterals.find(ascending(nodes));
    if (it == given_.quadrilaterals.end() || it->second.size() != 1)
      throw InputError(
          fmt::format("{}: an element of surface {} is in {} physical surfaces, but exactly one is required "
                      "(it names the region)",
                      source_, surface_, it == given_.quadrilaterals.end() ? 0 : it->second.size()));
    return *it->second.begin();
  }
  std::string name(int group) const {
    const std::string name = name_of_group(2, group);
    if (name.empty())
      throw InputError(fmt::format("{}: physical surface {} has no name; regions are chosen by name", source_, group));
    return name;
  }
  int first() const { return groups_.front(); }

 private:
  const std::string& source_;
  int surface_;
  const MshGroups& given_;
  std::vector<int> groups_;
};

// A mesh of several partitions may lie in as many files; one of them alone is a part of the dam.
void check_partitions(const std::string& source, const gmsh::vectorpair& surfaces, int partitions) {
  std::set<int> present;
  for (const auto& [dimension, tag] : surfaces) {
    std::vector<int> own;
    gmsh::model::getPartitions(dimension, tag, own);
    present.insert(own.begin(), own.end());
  }
  if (partitions > 1 && static_cast<int>(present.size()) < partitions)
    throw InputError(
        fmt::format("{}: the file holds {} of the mesh's {} partitions", source, present.size(), partitions));
}

// The plane of the mesh is z = constant; another one would be projected, and come out narrower or as a line.
void check_plane(const std::vector<double>& points, const std::string& source) {
  std::array<double, 3> low, high;
  for (std::size_t i = 0; i < 3; ++i) low[i] = high[i] = points.at(i);
  for (std::size_t k = 0; k < points.size(); ++k) {
    low[k % 3] = std::min(low[k % 3], points[k]);
    high[k % 3] = std::max(high[k % 3], points[k]);
  }
  const auto width = [&](std::size_t i) { return high[i] - low[i]; };
  const double size = std::max({width(0), width(1), width(2)});
  if (width(2) <= 1e-6 * size) return;
  for (const auto& [i, plane] : {std::pair{1, "x-z"}, std::pair{0, "y-z"}})
    if (width(static_cast<std::size_t>(i)) <= 1e-6 * size)
      throw InputError(
          fmt::format("{}: the mesh lies in the {} plane ({} = {:g} throughout), but the x-y plane is required, "
                      "with y upwards: turn the geometry, or swap the columns of the nodes",
                      source, plane, i == 1 ? "y" : "x", low[static_cast<std::size_t>(i)]));
  throw InputError(
      fmt::format("{}: the mesh is not plane: z goes from {:g} to {:g} m, but one z for all nodes is "
                  "required (the x-y plane, y upwards)",
                  source, low[2], high[2]));
}

void read_lines(const std::string& source, const MshGroups& given, const std::map<std::size_t, std::int64_t>& number,
                Mesh& mesh) {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, 1);
  std::map<std::string, std::set<std::array<std::int64_t, 2>>> taken;
  for (const auto& [dimension, group] : groups) {
    std::string name = name_of_group(dimension, group);
    if (name.empty()) name = fmt::format("curve_{}", std::abs(group));
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, group, entities);
    const auto own = given.lines.find(std::abs(group));
    std::size_t loose = 0;
    for (const int entity : entities) {
      std::vector<int> types;
      std::vector<std::vector<std::size_t>> element_tags, node_tags;
      gmsh::model::mesh::getElements(types, element_tags, node_tags, dimension, std::abs(entity));
      for (std::size_t k = 0; k < types.size(); ++k) {
        if (types[k] == gmsh_point) continue;
        if (types[k] != gmsh_line)
          fail_type(source, fmt::format("physical curve '{}'", name), types[k], element_tags[k].size());
        for (std::size_t i = 0; i + 1 < node_tags[k].size(); i += 2) {
          const auto p = node_tags[k][i], q = node_tags[k][i + 1];
          if (given.known &&
              (own == given.lines.end() || !own->second.contains({static_cast<std::int64_t>(std::min(p, q)),
                                                                  static_cast<std::int64_t>(std::max(p, q))})))
            continue;
          const auto a = number.find(p), b = number.find(q);
          if (a == number.end() || b == number.end()) {
            ++loose;
            continue;
          }
          // Once, though a file of version 2 has it for each group that it is in: loads and dashpots count edges.
          if (taken[name].insert({std::min(a->second, b->second), std::max(a->second, b->second)}).second)
            mesh.lines[name].push_back({a->second, b->second});
        }
      }
    }
    if (loose > 0)
      add_warning(
          fmt::format("{}: {} line elements of the physical curve '{}' touch no quadrilateral (a curve with nodes of "
                      "its own?) and are left out",
                      source, loose, name));
  }
}

// Node tags renumbered 0..N-1 in ascending order of tag, keeping only nodes of quadrilaterals.
Mesh mesh_of_current_model(const std::string& source, const MshGroups& given) {
  Mesh mesh;
  gmsh::vectorpair surfaces;
  gmsh::model::getEntities(surfaces, 2);
  check_partitions(source, surfaces, given.partitions);
  std::map<std::size_t, std::int64_t> number;  // of a node tag
  std::vector<std::size_t> quad_tags;
  std::map<int, std::int32_t> region_of_group;
  for (const auto& [dimension, tag] : surfaces) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> element_tags, node_tags;
    gmsh::model::mesh::getElements(types, element_tags, node_tags, dimension, tag);
    if (types.empty()) continue;
    const RegionOf region_of(source, tag, given);
    for (std::size_t k = 0; k < types.size(); ++k) {
      if (types[k] != gmsh_quad)
        fail_type(source, fmt::format("surface {} (region '{}')", tag, region_of.name(region_of.first())), types[k],
                  element_tags[k].size());
      quad_tags.insert(quad_tags.end(), node_tags[k].begin(), node_tags[k].end());
      for (std::size_t i = 0; i < node_tags[k].size(); i += 4) {
        const int group = region_of.group(&node_tags[k][i]);
        if (!region_of_group.contains(group)) {
          const std::string name = region_of.name(group);
          auto it = std::find(mesh.region_names.begin(), mesh.region_names.end(), name);
          if (it == mesh.region_names.end()) it = mesh.region_names.insert(it, name);
          region_of_group[group] = static_cast<std::int32_t>(it - mesh.region_names.begin());
        }
        mesh.region.push_back(region_of_group[group]);
      }
      for (const auto node : node_tags[k]) number[node] = 0;
    }
  }
  std::int64_t next = 0;
  std::vector<double> points;
  for (auto& [tag, n] : number) {
    n = next++;
    std::vector<double> position, parametric;
    gmsh::model::mesh::getNode(tag, position, parametric);
    points.insert(points.end(), position.begin(), position.end());
    mesh.position.insert(mesh.position.end(), {position[0], position[1]});
  }
  for (const auto tag : quad_tags) mesh.quads.push_back(number[tag]);
  if (!points.empty()) check_plane(points, source);
  read_lines(source, given, number, mesh);
  return mesh;
}

}  // namespace

Mesh mesh_geometry(const std::filesystem::path& geometry, const GeometryOptions& options,
                   const std::filesystem::path& output) {
  require_file(geometry);
  if (!options.trusted) refuse_commands(geometry);
  if (!output.parent_path().empty()) std::filesystem::create_directories(output.parent_path());
  // Beside the final name, and this process's own: two runs in one folder do not cut each other's file.
  const auto temporary = output.parent_path() / fmt::format("{}.{}.part.msh", output.stem().string(), getpid());
  IsolationLimits limits;
  limits.seconds = options.time_limit;
  limits.time_limit_name = "/mesh/time_limit";
  limits.memory = static_cast<std::size_t>(machine_memory());
  limits.may_start_programs = options.trusted;
  try {
    run_isolated(geometry.string(), limits, [&] {
      const Session session;
      for (const auto& [name, value] : options.parameters) gmsh::onelab::setNumber("Parameters/" + name, {value});
      open_or_throw(geometry);
      try {
        gmsh::model::mesh::generate(2);
      } catch (const std::bad_alloc&) {
        throw;
      } catch (...) {
        throw InputError(fmt::format("{}: gmsh cannot mesh it: {}", geometry.string(), Session::errors()));
      }
      gmsh::option::setNumber("Mesh.MshFileVersion", 4.1);
      gmsh::option::setNumber("Mesh.Binary", 0);
      gmsh::option::setNumber("Mesh.SaveAll", 0);
      try {
        gmsh::write(temporary.string());
      } catch (...) {
        throw InputError(fmt::format("{}: cannot be written", temporary.string()));
      }
      return std::string();
    });
    // What counts is what is on disk: the geometry's own options (Mesh.ScalingFactor) act on it, and so does a full
    // disk.
    Mesh mesh = read_gmsh(temporary, geometry.string());
    std::filesystem::rename(temporary, output);
    return mesh;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

Mesh read_gmsh(const std::filesystem::path& path, const std::string& source) {
  require_file(path);
  const MshGroups groups = audit_msh(path, source);
  IsolationLimits limits;
  limits.seconds = reading_time_limit;
  limits.memory = (std::size_t{1} << 31) + 500 * static_cast<std::size_t>(std::filesystem::file_size(path));
  try {
    const std::string bytes = run_isolated(source, limits, [&] {
      const Session session;
      forget_warnings();
      open_or_throw(path);
      return bytes_of(mesh_of_current_model(source, groups), warnings());
    });
    auto [mesh, remarks] = mesh_of_bytes(bytes);
    for (const auto& remark : remarks) add_warning(remark);
    check_mesh(mesh, source);
    return std::move(mesh);
  } catch (const InputError& error) {
    if (!groups.partitioned) throw;
    throw InputError(
        fmt::format("{}. The mesh is cut into partitions, of which this file may have one, or ghost cells of the "
                    "others: in gmsh, Mesh > Unpartition, and save it whole",
                    error.what()));
  }
}

Mesh read_gmsh(const std::filesystem::path& path) {
  return read_gmsh(path, path.string());
}

}  // namespace tailrun::fem

// What a .msh file says about itself, checked before gmsh reads it: gmsh takes the counts in it on trust and crashes,
// or asks for memory without end, where they lie.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace tailrun::fem {

// In MSH 2.2 every element carries its physical group, and stands in the file once for each group that it is in. gmsh
// keeps groups for whole entities only, so that elements of one entity with different groups all come to be in all of
// them.
struct MshGroups {
  bool partitioned = false;                                    // cut for several processes, perhaps one of the files
  int partitions = 0;                                          // of the whole, where an ASCII file says so
  bool known = false;                                          // an ASCII file of version 2: the next two
  std::map<int, std::set<std::array<std::int64_t, 2>>> lines;  // physical curve: edges, as ascending node tags
  std::map<std::array<std::int64_t, 4>, std::set<int>> quadrilaterals;  // ascending node tags: physical surfaces
};

// Throws InputError (file, line, what was found): no gmsh mesh, sections that do not end, counts that do not agree with
// what follows, node tags beyond 2^31 - 1 or twice, coordinates that are no numbers, elements with unknown nodes.
// Files in binary and of other versions pass unseen.
// `source` names the file in messages.
MshGroups audit_msh(const std::filesystem::path& path, const std::string& source);

}  // namespace tailrun::fem

// Freedoms of the mixed problem: three per node (u_x, u_y, p), fixed, free or tied to each other, and the numbering of
// the equations that results. Fixed freedoms keep their value (their increment is zero).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fem_stage/mesh/mesh.hpp"

namespace tailrun::fem {

enum Freedom { freedom_ux = 0, freedom_uy = 1, freedom_p = 2 };

class Freedoms {
 public:
  explicit Freedoms(std::size_t nodes);
  void fix(std::int64_t node, Freedom freedom);
  void tie(std::int64_t a, std::int64_t b, Freedom freedom);  // they share one equation; fixed if either is
  bool fixed(std::size_t node, Freedom freedom) const;

  struct Equations {
    int count = 0;
    std::vector<int> number;  // (N, 3), -1 where fixed
    // "u_x of node 12 at (3.2, 4)" for messages
    std::string describe(int equation, const Mesh& mesh) const;
  };
  // Numbers the free freedoms among those wanted; the others get -1.
  Equations number(bool displacement, bool pressure) const;

 private:
  std::size_t root(std::size_t freedom) const;
  std::vector<std::size_t> parent_;  // union-find over 3 N freedoms
  std::vector<char> fixed_;          // by root
};

// Ties nodes of `nodes` that have the same elevation (within `tolerance` m) to the first of them. Throws InputError,
// beginning with `where` (a place in the case file), when a node has no other at its elevation.
void tie_equal_heights(Freedoms& freedoms, const Mesh& mesh, std::span<const std::int64_t> nodes, double tolerance,
                       std::span<const Freedom> which, const std::string& where);

}  // namespace tailrun::fem

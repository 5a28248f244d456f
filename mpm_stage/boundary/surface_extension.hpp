// Nodes beyond the surface of a body, at which the body's velocity is continued instead of computed.
//
// A node that hardly any material reaches is moved by the few particles that touch it and by nothing else, so it gives
// way until their stress has no component along its gradient. On a surface that is not parallel to the grid, where
// stress along the surface should stay, the outermost particles thus lose theirs, and lose it again each time that the
// body has moved on over the grid: a beam that turns goes soft. So the freedom of such nodes is taken away, as in
// extended B-splines (Hoellig, Reif & Wipper 2001; for material points Yamaguchi, Moriguchi & Terada 2021): their
// velocity is the linear field that fits the velocities of the nodes inside, v_i = sum_j E_ij v_j, and what pushes them
// pushes these nodes instead, by the transpose of E. E reproduces linear fields.
//
// The mass matrix of the nodes inside is then E^T M E. Its row sums alone, as in the rest of the scheme, would not do:
// E has negative entries, and the transfer would amplify some velocity fields by a few per cent in each step.
#pragma once

#include <cstdint>
#include <vector>

#include "mpm_stage/grid/block_grid.hpp"
#include "mpm_stage/grid/simd.hpp"

namespace tailrun::mpm {

// What a node may be: anything; one to continue from but not itself continued (wall or ground hold its velocity); or
// neither (the image behind a mirror).
enum class SurfaceRole : std::uint8_t { any, held, none };

template <int Dim>
class SurfaceExtension {
 public:
  // Nodes with less than `share` of the mass of the heaviest node beside them are continued; 0: none.
  explicit SurfaceExtension(double share) : share_(share) {}

  bool active() const { return share_ > 0.0; }

  // The neighbours of the active blocks; call after each sort. `role` has Block::nodes values per active block, as have
  // all arrays below.
  void update(const BlockGrid<Dim>& grid, std::vector<SurfaceRole> role);

  // Chooses the nodes to be continued from the nodes' masses (lane 0 of `sums`, kg) and computes E.
  void choose(const Vec4* sums);

  // Masses (row sums of E^T M E) and momenta of the nodes inside, such that lanes 1 .. Dim over lane 0 are their
  // velocities. The continued nodes are emptied.
  void fold_momentum(Vec4* sums);
  // The same for forces (N; lane 0 is 0), after fold_momentum(sums).
  void fold_force(const Vec4* sums, Vec4* forces);
  // Sets the velocities of the continued nodes.
  void extend(Vec4* velocity) const;

  std::size_t count() const { return continued_.size(); }

 private:
  static constexpr int reach = 2;  // nodes
  struct Continued {
    std::size_t node;
    std::size_t first, last;  // in sources_
    double mass;              // kg
  };
  struct Source {
    std::size_t node;
    double weight;
  };
  struct Found {
    std::vector<Continued> continued;
    std::vector<Source> sources;
  };
  double heaviest_beside(const Vec4* sums, std::size_t a, int n) const;
  bool is_light(const Vec4* sums, std::size_t k, double heaviest) const;
  void fit(std::size_t a, int n, const Vec4* sums, double heaviest, Found& found) const;
  void fold(Vec4* sums) const;
  void solve(const Vec4* mass, Vec4* sums);

  double share_;
  std::vector<std::array<int, Block<Dim>::neighbours>> beside_;
  std::vector<SurfaceRole> role_;
  std::vector<std::uint8_t> light_;  // per node
  std::vector<Found> found_;         // per active block
  std::vector<Continued> continued_;
  std::vector<Source> sources_;
  AlignedVector<Vec4> given_, difference_;  // per source
};

}  // namespace tailrun::mpm

// Which blocks a velocity field is present in: those whose nodes its particles can come to before the next sort.
#include "mpm_stage/grid/field_layout.hpp"

#include <doctest/doctest.h>

#include <map>

using namespace tailrun::mpm;

namespace {

// Two particles in blocks of 8 x 8 cells of 1 m, the first of field 0 and the second of field 1.
struct Two {
  std::array<double, 2> first, second;
  BlockGrid<2> grid{1.0, {0.0, 0.0}, 0.5};
  FieldLayout<2> fields;
  Particles<2> P;

  Two(std::array<double, 2> a, std::array<double, 2> b) : first(a), second(b) {
    P.resize(2, true, false);
    for (std::size_t d = 0; d < 2; ++d) {
      P.position[d][0] = a[d];
      P.position[d][1] = b[d];
    }
    P.material[1] = 1;
    P.identity[1] = 1;
    FieldChoice choice;
    choice.of_material = {0, 1};
    choice.count = 2;
    grid.sort(P, {}, choice);
    // Three nodes to each side of the particle.
    fields.update(grid, 2, [this](std::size_t block, std::size_t begin, std::size_t) {
      FieldLayout<2>::Reach reach;
      for (std::size_t d = 0; d < 2; ++d) {
        const int at = static_cast<int>(P.position[d][begin]) - grid.occupied_index(block)[d] * 8;
        reach.low[d] = at - 3;
        reach.high[d] = at + 3;
      }
      return reach;
    });
  }
  // Block indices of the active blocks in which field f is present.
  std::map<std::array<int, 2>, std::size_t> present(int f) const {
    std::map<std::array<int, 2>, std::size_t> blocks;
    for (std::size_t a = 0; a < grid.active(); ++a)
      if (fields.present(f, a)) blocks[grid.active_index(a)] = a;
    return blocks;
  }
};

}  // namespace

TEST_CASE("a field is present in its particles' block, and beside it only where they come near") {
  const Two middle({4.0, 4.0}, {36.0, 4.0});
  CHECK(middle.present(0).size() == 1);
  CHECK(middle.present(0).contains({0, 0}));
  CHECK(middle.present(1).contains({4, 0}));
  CHECK(middle.fields.shared_blocks().empty());
  const Two corner({7.0, 6.0}, {36.0, 1.0});
  CHECK(corner.present(0).size() == 4);
  for (const std::array<int, 2> block : {std::array{0, 0}, {1, 0}, {0, 1}, {1, 1}})
    CHECK(corner.present(0).contains(block));
  CHECK(corner.present(1).size() == 2);
  CHECK(corner.present(1).contains({4, -1}));
}

TEST_CASE("a block that two fields reach is shared, and the tiles around it are those that reach it") {
  const Two near({4.0, 4.0}, {10.0, 4.0});  // the second comes to node 7 of the first one's block
  REQUIRE(near.fields.shared_blocks().size() == 1);
  const std::size_t a = near.fields.shared_blocks()[0];
  CHECK(near.grid.active_index(a) == std::array{0, 0});
  CHECK(near.fields.shared(a));
  CHECK(near.fields.around(0, a)[4] >= 0);  // its own
  CHECK(near.fields.around(1, a)[4] < 0);
  CHECK(near.fields.around(1, a)[5] >= 0);  // the one at larger x
  CHECK(near.fields.near_shared(0));
  const Two far({4.0, 4.0}, {11.0, 4.0});
  CHECK(far.fields.shared_blocks().empty());
}

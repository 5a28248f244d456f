#include "transfer_tool/sample/pond_reach.hpp"

#include <doctest/doctest.h>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

// 8 x 4 m, shaped into a dam: the ground falls to 2 m on the left of x = 3 and on the right of x = 6, the crest is at
// x = 5 with 4 m. Nodes of the top row from x = 0 to 3 are the line "upstream".
tailrun::Snapshot dam() {
  auto mesh = example::rectangle(8, 4, 0.0);
  const double top[9] = {2.0, 2.0, 2.0, 2.5, 3.5, 4.0, 3.0, 2.0, 2.0};
  for (std::size_t node = 0; node < mesh.nodes(); ++node)
    mesh.position[2 * node + 1] *= top[static_cast<std::size_t>(mesh.position[2 * node])] / 4.0;
  mesh.lines = {{"upstream", {36, 37, 37, 38, 38, 39}}, {"downstream", {42, 43, 43, 44}}};
  return mesh;
}

std::vector<bool> all(const tailrun::Snapshot& mesh) {
  return std::vector<bool>(mesh.elements(), true);
}

}  // namespace

TEST_CASE("a pond reaches from beyond the mesh to the crest that holds it back, in the deformed geometry") {
  auto mesh = dam();
  mesh.ponds = {{3.2, {"upstream"}}};
  auto reach = pond_reaches(mesh);
  REQUIRE(reach.size() == 1);
  CHECK(reach[0].name == "upstream");
  CHECK(reach[0].level == 3.2);
  CHECK(reach[0].endless == std::array<bool, 2>{true, false});
  CHECK(reach[0].extent[1] == 5.0);
  for (std::size_t node = 0; node < mesh.nodes(); ++node) mesh.displacement[2 * node] = 0.25;
  CHECK(pond_reaches(mesh)[0].extent[1] == 5.25);
  // Over the crest: nothing holds it.
  mesh.ponds[0].level = 4.5;
  CHECK(pond_reaches(mesh)[0].endless == std::array<bool, 2>{true, true});
}

TEST_CASE("ponds on both sides meet at the crest; one that lies below the ground is left out with a warning") {
  tailrun::forget_warnings();
  auto mesh = dam();
  mesh.ponds = {{3.2, {"upstream"}}, {2.4, {"downstream"}}, {1.0, {"downstream", "upstream"}}};
  const auto reach = pond_reaches(mesh);
  REQUIRE(reach.size() == 2);
  CHECK(reach[1].endless == std::array<bool, 2>{false, true});
  CHECK(reach[1].extent[0] == 5.0);
  REQUIRE(tailrun::warnings().size() == 1);
  CHECK(tailrun::warnings()[0].find("downstream|upstream") != std::string::npos);
  tailrun::forget_warnings();
}

TEST_CASE("a phreatic line above the ground needs a pond there") {
  tailrun::forget_warnings();
  auto mesh = dam();
  mesh.phreatic_line = {-1, 3.2, 4, 3.2, 6.5, 2.0, 9, 2.0};
  const auto refusal = example::message_of<tailrun::InputError>([&] { check_standing_water(mesh, all(mesh), {}); });
  CHECK(refusal.find("1.2 m above the ground") != std::string::npos);
  CHECK(refusal.find("ponded_water") != std::string::npos);
  check_standing_water(mesh, all(mesh), {}, true);  // of tables, of which elements may be left out later
  CHECK(tailrun::warnings().size() == 1);
  tailrun::forget_warnings();
  mesh.ponds = {{3.2, {"upstream"}}};
  check_standing_water(mesh, all(mesh), pond_reaches(mesh));
  CHECK(tailrun::warnings().empty());
  mesh.phreatic_line = {-1, 2.3, 4, 2.3, 6.5, 1.5, 9, 1.5};
  check_standing_water(mesh, all(mesh), {});
  CHECK(tailrun::warnings().size() == 1);
  tailrun::forget_warnings();
}

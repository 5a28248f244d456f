// Horizontal stresses, velocities and displacements of another program that cannot be meant are said; others are not.
#include "transfer_tool/import/motion_and_rest.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "example_mesh.hpp"

using namespace tailrun;
using namespace tailrun::transfer;

namespace {

// Soil at rest, 20 m wide and 10 m high, dry, of 1800 and 2000 kg/m3, with K = sigma'_xx / sigma'_yy, 10 s after the
// beginning of a motion.
Snapshot at_rest(double ratio, double vertical = 1.0) {
  Snapshot s = example::rectangle(20, 10, 0.0);
  s.time = 10.0;
  for (std::size_t e = 0; e < s.elements(); ++e) {
    const double depth = 9.5 - static_cast<double>(e / 20);
    s.depth[e] = depth;
    const double stress = 9.81 * (depth < 5.0 ? 2000.0 * depth : 10000.0 + 1800.0 * (depth - 5.0));
    s.initial_vertical_effective_stress[e] = vertical * stress;
    s.initial_effective_stress[4 * e] = -ratio * vertical * stress;
    s.initial_effective_stress[4 * e + 1] = -vertical * stress;
  }
  return s;
}

// All nodes with these velocities (m/s) and displacements (m) along x.
Snapshot moving(double velocity, double displacement) {
  Snapshot s = at_rest(0.5);
  for (std::size_t n = 0; n < s.nodes(); ++n) {
    s.velocity[2 * n] = velocity;
    s.displacement[2 * n] = displacement;
  }
  return s;
}

std::string said(const Snapshot& snapshot) {
  const example::TemporaryFolder folder;
  const CaseFile file(folder.write("import.json", R"({"element_state": "e.csv"})"));
  forget_warnings();
  const std::string refusal = example::message_of<InputError>([&] { check_rest_and_motion(file.root(), snapshot); });
  std::string all;
  for (const auto& warning : warnings()) all += warning;
  forget_warnings();
  return refusal.empty() ? all : "error: " + refusal;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("soil at rest: normally consolidated, stiff clay, elastic, none") {
  for (const double ratio : {0.3, 0.5, 1.0, 2.0, 3.0}) CHECK_MESSAGE(said(at_rest(ratio)) == "", ratio);
  CHECK(said(example::rectangle(4, 4)) == "");
}

TEST_CASE("horizontal stresses of another sign, of another unit, exchanged with vertical ones") {
  CHECK(said(at_rest(-0.5)).starts_with("error: "));
  CHECK(contains(said(at_rest(-0.5)),
                 "/element_state: sxx is a tension in 200 of 200 elements whose syy is a compression"));
  CHECK(contains(said(at_rest(-0.01)), "is the sign of sxx right?"));
  CHECK_FALSE(said(at_rest(-0.01)).starts_with("error: "));
  CHECK(contains(said(at_rest(500.0)), "most likely the two columns have different units"));
  CHECK(said(at_rest(500.0)).starts_with("error: "));
  CHECK(contains(said(at_rest(0.0005)), "do the two columns have the same unit and sign?"));
  // K0 of 0.5 and 0.7 the other way round.
  CHECK(contains(said(at_rest(2.0, 0.5)), "are the two columns exchanged?"));
  CHECK(contains(said(at_rest(1.0 / 0.7, 0.7)), "are the two columns exchanged?"));
}

TEST_CASE("tensions near the ground are those of slopes and cuts") {
  Snapshot s = at_rest(0.5);
  for (std::size_t e = 140; e < s.elements(); ++e) s.initial_effective_stress[4 * e] = 1e3;
  CHECK(said(s) == "");
}

TEST_CASE("velocities in mm/s and impossible ones") {
  for (const auto& [velocity, displacement] : {std::pair{1.0, 0.3}, std::pair{20.0, 4.0}, std::pair{0.5, 0.0}})
    CHECK(said(moving(velocity, displacement)) == "");
  CHECK(contains(said(moving(500.0, 0.3)), "/node_state: nodes move with up to 500 m/s"));
  CHECK(contains(said(moving(500.0, 0.3)), "500 mm/s are 0.5 m/s"));
  CHECK(said(moving(2e3, 0.3)).starts_with("error: "));
  CHECK(contains(said(moving(50.0, 0.1)),
                 "but none is farther than 0.1 m from where it was before the shaking, 10 s ago"));
}

TEST_CASE("displacements in millimetres, and farther than the mesh is long") {
  CHECK(said(moving(0.5, 4.0)) == "");
  CHECK(contains(said(moving(0.5, 8.0)), "/node_state: nodes have moved by up to 8 m"));
  CHECK(contains(said(moving(0.5, 300.0)), "but the whole mesh is 22.36 m from corner to corner"));
  CHECK(said(moving(0.5, 300.0)).starts_with("error: "));
}

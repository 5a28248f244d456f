#include "fem_stage/element_test/element_test_case.hpp"

#include <fmt/core.h>

#include "common/case_file.hpp"
#include "common/plausible_material.hpp"
#include "common/plausible_stiffness.hpp"
#include "common/plausible_voids.hpp"

namespace tailrun::fem {

namespace {

constexpr double most_increments = 1e8;  // some minutes

ElementTestType read_type(const CaseNode& loading) {
  const std::string word = loading.choice(
      "type", {"cyclic_simple_shear", "monotonic_simple_shear", "plane_strain_compression", "strain_path"});
  if (word == "cyclic_simple_shear") return ElementTestType::cyclic_simple_shear;
  if (word == "monotonic_simple_shear") return ElementTestType::monotonic_simple_shear;
  if (word == "plane_strain_compression") return ElementTestType::plane_strain_compression;
  return ElementTestType::strain_path;
}

Drainage read_drainage(const CaseNode& loading) {
  const std::string word =
      loading.choice_or("drainage", {"constant_volume", "undrained", "drained"}, "constant_volume");
  if (word == "undrained") return Drainage::undrained;
  return word == "drained" ? Drainage::drained : Drainage::constant_volume;
}

void read_path(const CaseNode& loading, ElementTestCase& test) {
  for (const CaseNode& leg : loading.list("path")) {
    const std::vector<double> e = leg.numbers("increment", "1", Range::between(-0.1, 0.1), 3);
    test.path.push_back({{e[0], e[1], e[2]}, leg.integer_or("repeats", 1, 100000000, 1)});
  }
  if (test.path.empty())
    loading.fail("path", "an empty list; give at least one {\"increment\": [...], \"repeats\": n}");
}

}  // namespace

ElementTestCase read_element_test(const std::filesystem::path& case_file) {
  const CaseFile file(case_file);
  const CaseNode root = file.root();
  ElementTestCase test;
  check_voids(root.object("material"));
  test.material = read_material(root.object("material"), "element test");
  check_material(root.object("material"), {});

  const CaseNode initial = root.object_or_empty("initial");
  test.vertical_effective_stress =
      initial.number_or("vertical_effective_stress", "Pa", Range::positive(), test.vertical_effective_stress);
  check_ground_stress(initial, "vertical_effective_stress");
  test.K0 = initial.number_or("K0", "1", Range::positive(), test.K0);
  test.static_shear_ratio = initial.number_or("static_shear_ratio", "1", Range::between(-2.0, 2.0), 0.0);

  const CaseNode loading = root.object("loading");
  test.type = read_type(loading);
  const CaseNode stop = root.object_or_empty("stop");
  const bool compression = test.type == ElementTestType::plane_strain_compression;
  if (test.type == ElementTestType::strain_path) {
    read_path(loading, test);
  } else {
    test.drainage = read_drainage(loading);
    const char* key = compression ? "axial_strain_increment" : "shear_strain_increment";
    test.strain_increment = loading.number_or(key, "1", {0.0, 0.05, true, false}, test.strain_increment);
    if (test.drainage == Drainage::undrained) {
      test.fluid_bulk_modulus =
          loading.number_or("fluid_bulk_modulus", "Pa", Range::positive(), test.fluid_bulk_modulus);
      check_water_stiffness(loading, "fluid_bulk_modulus", test.fluid_bulk_modulus, 9.81);
      check_voids(loading);
      test.porosity = loading.number_or("porosity", "1", Range::open(0.0, 1.0), porosity_of(test.material));
    }
    test.stop_strain =
        stop.number_or(compression ? "axial_strain" : "shear_strain", "1", Range::positive(), test.stop_strain);
    if (!(test.stop_strain / test.strain_increment <= most_increments))
      loading.fail(key,
                   fmt::format("found {:g}, which makes {:.3g} increments to a strain of {:g}, but at most {:g} are "
                               "allowed",
                               test.strain_increment, test.stop_strain / test.strain_increment, test.stop_strain,
                               most_increments));
  }
  if (test.type == ElementTestType::cyclic_simple_shear) {
    test.csr = loading.number("csr", "1", Range::positive());
    check_fraction(loading, "csr");
    test.stop_cycles = stop.number_or("cycles", "1", Range::positive(), test.stop_cycles);
  }
  const CaseNode output = root.object_or_empty("output");
  test.output_every = output.integer_or("every", 0, 1000000000, 0);
  test.report_strains = output.numbers_or("report_strains", "1", Range::positive(), test.report_strains);
  file.finish();
  return test;
}

}  // namespace tailrun::fem

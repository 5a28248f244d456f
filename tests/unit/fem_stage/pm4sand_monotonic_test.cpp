// Monotonic tests of PM4Sand: undrained strength after the peak, drained shearing.
#include <doctest/doctest.h>

#include "material_drive.hpp"

using namespace tailrun::fem;
using namespace tailrun::fem::testing;

namespace {

ElementTestCase shear_test(const Pm4SandParameters& parameters, double vertical, double strain) {
  ElementTestCase test;
  test.material = {"", parameters};
  test.type = ElementTestType::monotonic_simple_shear;
  test.vertical_effective_stress = vertical;
  test.strain_increment = 1e-5;
  test.stop_strain = strain;
  test.output_every = 1;
  return test;
}

// Largest difference of the shear stress from the table up to `most_strain`, relative to the table's peak.
double shear_error(const ElementTestResult& result, const Table& table, double most_strain) {
  const auto strain = column(result, &ElementTestRow::shear_strain);
  const auto stress = column(result, &ElementTestRow::shear_stress);
  double worst = 0.0, peak = 0.0;
  for (std::size_t i = 0; i < table.rows && table["gamma"][i] <= most_strain; ++i) {
    peak = std::max(peak, table["tau_kPa"][i]);
    worst = std::max(worst, std::fabs(interpolate(strain, stress, table["gamma"][i]) / 1e3 - table["tau_kPa"][i]));
  }
  return worst / peak;
}

}  // namespace

TEST_CASE("PM4Sand undrained monotonic shear to 50 %: compatible mode within 0.3 % of the peak") {
  for (const double kPa : {17.0, 186.0}) {
    const auto result = simulate(shear_test(as_opensees(tailings()), 1e3 * kPa, 0.5));
    CHECK(shear_error(result, read_table("monotonic_tailings_sv" + std::to_string(int(kPa)) + ".csv"), 0.5) < 3e-3);
  }
  const auto result = simulate(shear_test(as_opensees(loose()), 100e3, 0.5));
  CHECK(shear_error(result, read_table("monotonic_loose_sv100.csv"), 0.5) < 3e-3);
}

// At the bounding surface OpenSees' yield correction moves the stress, which leaves its residual strength a few per
// cent above the one that the model's own equations have (and depends on its step). The improved mode has no such part.
TEST_CASE("PM4Sand undrained monotonic shear: improved mode within 2 % of the peak up to 10 % strain") {
  for (const double kPa : {17.0, 186.0}) {
    const auto result = simulate(shear_test(tailings(), 1e3 * kPa, 0.1));
    CHECK(shear_error(result, read_table("monotonic_tailings_sv" + std::to_string(int(kPa)) + ".csv"), 0.1) < 0.02);
  }
  CHECK(shear_error(simulate(shear_test(loose(), 100e3, 0.5)), read_table("monotonic_loose_sv100.csv"), 0.5) < 3e-3);
}

TEST_CASE(
    "PM4Sand improved mode: strength while flowing does not depend on the strain step, and nears p_cs sin phi_cv") {
  double reference = 0.0;
  for (const double step : {1e-5, 1e-4, 1e-3, 5e-3}) {
    ElementTestCase test = shear_test(tailings(), 17e3, 1.0);
    test.strain_increment = step;
    test.output_every = 0;
    test.report_strains = {0.3};
    const ElementTestResult result = simulate(test);
    const double at_30_percent = result.shear_stress_at_strain[0].second.value();
    if (reference == 0.0) reference = at_30_percent;
    CHECK(at_30_percent == doctest::Approx(reference).epsilon(5e-3));
    CHECK(result.rows.back().shear_stress > 1992.0);
    CHECK(result.rows.back().shear_stress < 1.02 * 1992.0);
  }
}

TEST_CASE("PM4Sand drained simple shear: stress and volume change as OpenSees' element") {
  for (const std::string name : {"loose", "embankment", "foundation"}) {
    for (const bool opensees : {true, false}) {
      ElementTestCase test = shear_test(opensees ? as_opensees(named(name)) : named(name), 100e3, 0.2);
      test.drainage = Drainage::drained;
      test.strain_increment = 2e-5;
      const ElementTestResult result = simulate(test);
      const Table table = read_table("drained_" + name + "_sv100.csv");
      INFO(name << (opensees ? " compatible" : " improved"));
      CHECK(shear_error(result, table, 0.2) < (opensees ? 5e-3 : 0.025));
      const auto strain = column(result, &ElementTestRow::shear_strain);
      const auto volume = column(result, &ElementTestRow::volumetric_strain);
      double worst = 0.0;
      for (std::size_t i = 0; i < table.rows; ++i) {
        worst = std::max(worst, std::fabs(interpolate(strain, volume, table["gamma"][i]) - table["eps_v"][i]));
      }
      CHECK(worst < (opensees ? 1e-4 : 5e-4));  // of up to 3 %
      for (const ElementTestRow& row : result.rows) CHECK(std::fabs(row.vertical_effective_stress - 100e3) < 200.0);
    }
  }
}

TEST_CASE("PM4Sand drained plane strain compression: deviator stress within 1 %") {
  ElementTestCase test;
  test.material = {"", as_opensees(loose())};
  test.type = ElementTestType::plane_strain_compression;
  test.drainage = Drainage::drained;
  test.K0 = 1.0;
  test.strain_increment = 2e-5;
  test.stop_strain = 0.15;
  test.output_every = 10;
  const ElementTestResult result = simulate(test);
  const Table table = read_table("drained_compression_loose.csv");
  std::vector<double> axial, q;
  for (const ElementTestRow& row : result.rows) {
    axial.push_back(0.5 * (row.shear_strain + row.volumetric_strain));
    q.push_back(2e-3 * row.shear_stress);
  }
  for (std::size_t i = 0; i < table.rows; ++i) {
    CHECK(std::fabs(interpolate(axial, q, table["eps_axial"][i]) - table["q_kPa"][i]) < 2.5);  // of 248
  }
}

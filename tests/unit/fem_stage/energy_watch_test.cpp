// When the energy ledger counts as open, and what is said then.
#include <doctest/doctest.h>

#include "fem_stage/solver/energy_watch.hpp"

using namespace tailrun::fem;

namespace {

Model two_elements() {
  Model model;
  model.mesh.position = {0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1};
  model.mesh.quads = {0, 1, 4, 3, 1, 2, 5, 4};
  model.mesh.region = {0, 0};
  model.mesh.region_names = {"beach"};
  return model;
}

}  // namespace

TEST_CASE("energy watch: silent within 1 %, also after it was open for a while") {
  const Model model = two_elements();
  const std::vector<double> hourglass = {1.0, 2.0};
  EnergyLedger ledger;
  ledger.external_work = 100.0;
  ledger.skeleton_work = 95.0;
  EnergyWatch watch;
  watch.observe(ledger, 0.1);
  CHECK(watch.open_since().value() == 0.1);
  ledger.skeleton_work = 99.5;
  watch.observe(ledger, 0.2);
  CHECK_FALSE(watch.hourglass_since());
  CHECK_FALSE(watch.open_since());
  CHECK(watch.warning(model, ledger, hourglass).empty());
}

TEST_CASE("energy watch: energy from nowhere is named with its time and the elements") {
  const Model model = two_elements();
  const std::vector<double> hourglass = {1.0, 20.0};
  EnergyLedger ledger;
  ledger.external_work = 100.0;
  ledger.skeleton_work = 103.0;
  EnergyWatch watch;
  watch.observe(ledger, 8.5);
  watch.observe(ledger, 9.0);
  const std::string made = watch.warning(model, ledger, hourglass);
  CHECK(made.find("made by nothing from 8.50 s on") != std::string::npos);
  CHECK(made.find("element 1 at (1.5, 0.5) in 'beach' 20 J, element 0") != std::string::npos);
  ledger.skeleton_work = 96.9;
  ledger.hourglass_work = 3.0;
  watch.observe(ledger, 9.5);
  CHECK_FALSE(watch.open_since());
  CHECK(watch.warning(model, ledger, hourglass).find("more than 2 % from 9.50 s on, 3.0 %") != std::string::npos);
  ledger.skeleton_work = 80.0;
  watch.observe(ledger, 10.0);
  CHECK(watch.warning(model, ledger, hourglass).find("lost to the time integration") != std::string::npos);
}

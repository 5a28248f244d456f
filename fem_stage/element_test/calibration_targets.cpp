#include "fem_stage/element_test/calibration_targets.hpp"

#include <cmath>

#include "common/plausible_material.hpp"
#include "fem_stage/element_test/element_test_case.hpp"

namespace tailrun::fem {

namespace {

ElementTestCase cyclic_test(const Pm4SandParameters& sand, const CyclicTarget& target, double csr, double most_cycles) {
  ElementTestCase test;
  test.material = {"calibration", sand};
  test.vertical_effective_stress = target.vertical_effective_stress;
  test.K0 = target.K0;
  test.static_shear_ratio = target.static_shear_ratio;
  test.csr = csr;
  test.stop_cycles = most_cycles;
  test.stop_strain = target.shear_strain;
  return test;
}

}  // namespace

double cycles_to_failure(const Pm4SandParameters& sand, const CyclicTarget& target, double csr, double most_cycles) {
  return simulate(cyclic_test(sand, target, csr, most_cycles)).cycles;
}

double working_strength(const Pm4SandParameters& sand, const Targets& targets, double vertical_effective_stress) {
  ElementTestCase test;
  test.material = {"calibration", sand};
  test.vertical_effective_stress = vertical_effective_stress;
  test.K0 = targets.residual_K0;
  test.type = ElementTestType::monotonic_simple_shear;
  test.strain_increment = 1e-4;
  test.stop_strain = targets.working_strain;
  return simulate(test).rows.back().shear_stress;
}

double mean_log_strength_ratio(const Pm4SandParameters& sand, const Targets& targets) {
  double sum = 0.0;
  for (const StrengthTarget& t : targets.residual) {
    sum += std::log(working_strength(sand, targets, t.vertical_effective_stress) / t.shear_stress);
  }
  return sum / static_cast<double>(targets.residual.size());
}

Targets read_targets(const CaseNode& root) {
  Targets targets;
  if (const auto node = root.object_if("cyclic_strength")) {
    CyclicTarget t;
    t.csr = node->number("csr", "1", Range::positive());
    check_fraction(*node, "csr");
    t.cycles = node->number_or("cycles", "1", Range::between(0.5, 1000.0), t.cycles);
    t.shear_strain = node->number_or("shear_strain", "1", Range::open(0.0, 0.5), t.shear_strain);
    t.vertical_effective_stress =
        node->number_or("vertical_effective_stress", "Pa", Range::positive(), t.vertical_effective_stress);
    check_ground_stress(*node, "vertical_effective_stress");
    t.K0 = node->number_or("K0", "1", Range::positive(), t.K0);
    t.static_shear_ratio = node->number_or("static_shear_ratio", "1", Range::between(-1.0, 1.0), 0.0);
    targets.cyclic = t;
  }
  if (const auto node = root.object_if("residual_strength")) {
    targets.working_strain = node->number_or("shear_strain", "1", Range::open(0.0, 2.0), targets.working_strain);
    targets.residual_K0 = node->number_or("K0", "1", Range::positive(), targets.residual_K0);
    for (const CaseNode& row : node->list("targets")) {
      targets.residual.push_back({row.number("vertical_effective_stress", "Pa", Range::positive()),
                                  row.number("shear_stress", "Pa", Range::positive())});
      check_ground_stress(row, "vertical_effective_stress");
      check_residual_strength(row, "shear_stress", targets.residual.back().shear_stress);
    }
    if (targets.residual.empty()) node->fail("targets", "an empty list");
  }
  if (!targets.cyclic && targets.residual.empty()) {
    root.fail("", "neither cyclic_strength nor residual_strength is given; there is nothing to calibrate to");
  }
  return targets;
}

}  // namespace tailrun::fem
